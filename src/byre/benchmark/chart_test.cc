#include "byre/benchmark/plots.h"

#include <algorithm>
#include <regex>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

// First violation of well-formed XML, tags only; empty for none.
std::string fault_of_xml(const std::string& text) {
  static const std::regex kTag(R"re(<(/?)([a-z]+)((?: [A-Za-z0-9_:-]+="[^"<>&]*")*)(/?)>)re");
  std::vector<std::string> open;
  std::string between;
  std::size_t end = 0;
  for (std::sregex_iterator tag(text.begin(), text.end(), kTag); tag != std::sregex_iterator(); ++tag) {
    between += text.substr(end, static_cast<std::size_t>(tag->position()) - end);
    end = static_cast<std::size_t>(tag->position() + tag->length());
    if ((*tag)[1].length() > 0) {
      if (open.empty() || open.back() != (*tag)[2]) return "</" + (*tag)[2].str() + "> closes nothing";
      open.pop_back();
    } else if ((*tag)[4].length() == 0) {
      open.push_back((*tag)[2]);
    }
  }
  if (!open.empty()) return "<" + open.back() + "> stays open";
  if (std::ranges::any_of(between, [](char character) { return character == '<' || character == '>'; })) {
    return "a bracket outside of tags";
  }
  return "";
}

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

Chart parabola() {
  Chart chart{"Drop & <rise>", "a > b", "time [s]", "height [m]"};
  ChartSeries series{"ball", "#0072b2", 1.6, {{}}};
  for (int i = 0; i <= 100; ++i) series.pieces[0].push_back({0.1 * i, 0.01 * i * i});
  chart.series = {series};
  return chart;
}

TEST(Chart, IsWellFormed) {
  const std::string svg = to_svg(parabola());
  EXPECT_EQ(fault_of_xml(svg), "");
  EXPECT_THAT(svg, HasSubstr("Drop &amp; &lt;rise&gt;"));
  EXPECT_EQ(fault_of_xml("<svg><g></svg>"), "</svg> closes nothing") << "the check itself";
}

TEST(Chart, NamesAxesAndSeries) {
  const std::string svg = to_svg(parabola());
  for (const char* text : {">time [s]<", ">height [m]<", ">ball<", ">10<", ">100<"}) EXPECT_THAT(svg, HasSubstr(text));
  EXPECT_EQ(count(svg, "<polyline"), 1);
}

TEST(Chart, BreaksLinesAtGaps) {
  Chart chart = parabola();
  chart.series[0].pieces.push_back({{11.0, 3.0}, {12.0, 5.0}});
  EXPECT_EQ(count(to_svg(chart), "<polyline"), 2);
}

TEST(Chart, OmitsNonPositiveValuesOnLogarithmicAxes) {
  Chart chart = parabola();
  chart.log_y = true;
  const std::string svg = to_svg(chart);
  EXPECT_EQ(fault_of_xml(svg), "");
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, HasSubstr(">0.1<"));
}

TEST(Chart, DrawsAxesWithoutPoints) {
  Chart chart = parabola();
  chart.series[0].pieces.clear();
  for (const bool logarithmic : {false, true}) {
    chart.log_y = logarithmic;
    const std::string svg = to_svg(chart);
    EXPECT_EQ(fault_of_xml(svg), "");
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
  }
}

// Corners of the polyline, in pixels.
std::vector<Eigen::Vector2d> corners(const std::string& svg) {
  static const std::regex kPoint(R"((-?[0-9.]+),(-?[0-9.]+))");
  const std::size_t begin = svg.find("points=\"");
  const std::string points = svg.substr(begin, svg.find("\"/>", begin) - begin);
  std::vector<Eigen::Vector2d> result;
  for (std::sregex_iterator point(points.begin(), points.end(), kPoint); point != std::sregex_iterator(); ++point) {
    result.emplace_back(std::stod((*point)[1]), std::stod((*point)[2]));
  }
  return result;
}

TEST(Chart, DrawsEqualScalesOnRequest) {
  Chart chart = parabola();
  chart.equal_scales = true;
  for (const double height : {0.5, 3.0, 40.0}) {
    chart.series[0].pieces = {{{0.0, 0.0}, {3.0, 0.0}, {3.0, height}}};
    const auto pixels = corners(to_svg(chart));
    ASSERT_THAT(pixels, SizeIs(3));
    const double across = (pixels[1].x() - pixels[0].x()) / 3.0, up = (pixels[1].y() - pixels[2].y()) / height;
    EXPECT_NEAR(across, up, 0.01 * up + 0.1) << height;
  }
}

TEST(Chart, StacksBelowAnotherChart) {
  Chart second = parabola();
  second.title = "Again";
  const std::string svg = to_svg(std::vector<Chart>{parabola(), second});
  EXPECT_EQ(fault_of_xml(svg), "");
  EXPECT_EQ(count(svg, "<polyline"), 2);
  EXPECT_EQ(count(svg, "<svg"), 1);
  EXPECT_THAT(svg, HasSubstr(">Again<"));
}

TEST(RoundTicks, DivideRangesEvenly) {
  EXPECT_THAT(round_ticks(1.0, 11.0), ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0));
  EXPECT_THAT(round_ticks(-3.0, 30.0), ElementsAre(0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0));
  for (const double length : {0.003, 0.7, 12.0, 999.0, 40000.0}) {
    const std::size_t ticks = round_ticks(0.1, 0.1 + length).size();
    EXPECT_GE(ticks, 4u) << length;
    EXPECT_LE(ticks, 11u) << length;
  }
}

CaseResult case_with_a_gap() {
  CaseResult result;
  result.what = {"b*", "b", "a", {Arm::hybrid}};
  ArmResult arm;
  arm.arm = Arm::hybrid;
  for (const int i : {0, 1, 2, 40, 41}) {
    const Timestamp time = i * std::chrono::milliseconds(50);
    result.truth.push_back({time, {Eigen::Quaterniond::Identity(), {1.0 * i, 2.0, 3.0}}});
    arm.final_trace.push_back({time, {1.0 * i, 2.5, 3.5}, 0.5});
  }
  arm.causal_trace = arm.final_trace;
  result.arms = {arm};
  return result;
}

TEST(PathChart, DrawsTheTruthBelowTheArms) {
  const Chart chart = path_chart(case_with_a_gap());
  ASSERT_THAT(chart.series, SizeIs(2));
  EXPECT_EQ(chart.series[0].name, "truth");
  EXPECT_EQ(chart.series[1].name, "hybrid");
  EXPECT_THAT(chart.series[1].pieces, SizeIs(2)) << "a gap of two seconds";
  EXPECT_EQ(chart.series[1].pieces[1][0], Eigen::Vector2d(40.0, 2.5));
  EXPECT_TRUE(chart.equal_scales);
  EXPECT_THAT(chart.subtitle, HasSubstr("b on the map of a"));
}

TEST(PathChart, ProjectsKittiAlongItsVerticalAxis) {
  CaseResult result = case_with_a_gap();
  result.format = RecordingFormat::kitti;
  EXPECT_EQ(path_chart(result).series[1].pieces[1][0], Eigen::Vector2d(40.0, 3.5));
  EXPECT_EQ(path_chart(result).y_label, "z [m]");
}

TEST(ErrorChart, CountsTimeFromTheStart) {
  const Chart chart = error_chart(case_with_a_gap());
  ASSERT_THAT(chart.series, SizeIs(1));
  ASSERT_THAT(chart.series[0].pieces, SizeIs(2));
  EXPECT_EQ(chart.series[0].pieces[1][0], Eigen::Vector2d(2.0, 500.0));
  EXPECT_EQ(fault_of_xml(to_svg(chart)), "");
}

}  // namespace
}  // namespace byre
