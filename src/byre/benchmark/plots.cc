#include "byre/benchmark/plots.h"

#include "byre/base/enum_names.h"
#include "byre/base/markup.h"
#include "byre/benchmark/measures.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/core.h>

namespace byre {
namespace {

constexpr double kWidth = 860.0, kLeft = 72.0, kRight = 24.0, kTop = 92.0, kBottom = 56.0;  // pixels
constexpr double kPlotWidth = kWidth - kLeft - kRight;
constexpr double kPlotHeight = 340.0, kMinPlotHeight = 260.0, kMaxPlotHeight = 760.0;
constexpr double kMargin = 0.05;  // share of the value range, on each side
constexpr const char* kInk = "#222222";
constexpr const char* kFaint = "#666666";
constexpr const char* kGrid = "#e4e4e0";
constexpr const char* kPaper = "#fdfdfb";

struct Range {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();

  double length() const { return most - least; }
  double middle() const { return 0.5 * (least + most); }
  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  void grow_to(double new_length) { *this = {middle() - 0.5 * new_length, middle() + 0.5 * new_length}; }
};

// Mapping from values to pixels; y is the logarithm on a logarithmic axis.
struct ChartFrame {
  Range x;
  Range y;
  double height = kPlotHeight;

  Eigen::Vector2d pixel(double x_value, double y_value) const {
    return {kLeft + kPlotWidth * (x_value - x.least) / x.length(), kTop + height * (y.most - y_value) / y.length()};
  }
};

bool is_drawn(const Chart& chart, const Eigen::Vector2d& point) {
  return !chart.log_y || point.y() > 0.0;
}

double axis_y(const Chart& chart, double y) {
  return chart.log_y ? std::log10(y) : y;
}

void for_each_point(const Chart& chart, const std::function<void(const Eigen::Vector2d&)>& visit) {
  for (const ChartSeries& series : chart.series) {
    for (const auto& piece : series.pieces) {
      for (const Eigen::Vector2d& point : piece) {
        if (is_drawn(chart, point)) visit({point.x(), axis_y(chart, point.y())});
      }
    }
  }
}

// Adds a margin; gives a non-empty range also for equal or no values.
Range widened(const Range& range) {
  if (range.least > range.most) return {0.0, 1.0};
  Range result = range;
  result.grow_to(range.length() > 0.0 ? range.length() * (1.0 + 2.0 * kMargin) : 1.0);
  return result;
}

void equalise_scales(ChartFrame& frame) {
  frame.height = std::clamp(kPlotWidth * frame.y.length() / frame.x.length(), kMinPlotHeight, kMaxPlotHeight);
  const double metres_per_pixel = std::max(frame.x.length() / kPlotWidth, frame.y.length() / frame.height);
  frame.x.grow_to(metres_per_pixel * kPlotWidth);
  frame.y.grow_to(metres_per_pixel * frame.height);
}

ChartFrame frame_of(const Chart& chart) {
  ChartFrame frame;
  for_each_point(chart, [&frame](const Eigen::Vector2d& point) {
    frame.x.add(point.x());
    frame.y.add(point.y());
  });
  if (!chart.log_y && !chart.equal_scales) frame.y.add(0.0);
  frame.x = widened(frame.x);
  frame.y = widened(frame.y);
  if (chart.equal_scales) equalise_scales(frame);
  return frame;
}

std::string text_at(double x, double y, const std::string& text, const std::string& attributes = "") {
  const std::string place = fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"", x, y);
  return place + (attributes.empty() ? "" : " " + attributes) + ">" + markup_escaped(text) + "</text>\n";
}

std::string line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const char* colour) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", from.x(),
                     from.y(), to.x(), to.y(), colour);
}

struct Tick {
  double at = 0.0;  // position; logarithm on a logarithmic axis
  std::string label;
};

// Labels have as many digits as distinguish neighbours.
std::vector<Tick> linear_ticks(const Range& range) {
  const std::vector<double> values = round_ticks(range.least, range.most);
  const double step = values.size() > 1 ? values[1] - values[0] : 1.0;
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  std::vector<Tick> ticks;
  for (const double value : values) ticks.push_back({value, fmt::format("{:.{}f}", value, digits)});
  return ticks;
}

// Powers of ten; over few decades also 2 and 5 times as much.
std::vector<Tick> logarithmic_ticks(const Range& range) {
  constexpr double kFewDecades = 4.0;
  const std::vector<double> factors =
      range.length() < kFewDecades ? std::vector<double>{1.0, 2.0, 5.0} : std::vector<double>{1.0};
  std::vector<Tick> ticks;
  for (int power = static_cast<int>(std::floor(range.least)); power <= range.most; ++power) {
    for (const double factor : factors) {
      const double value = factor * std::pow(10.0, power);
      if (std::log10(value) >= range.least && std::log10(value) <= range.most) {
        ticks.push_back({std::log10(value), fmt::format("{:g}", value)});
      }
    }
  }
  return ticks;
}

std::string axes(const Chart& chart, const ChartFrame& frame) {
  std::string svg;
  for (const Tick& tick : linear_ticks(frame.x)) {
    const Eigen::Vector2d foot = frame.pixel(tick.at, frame.y.least);
    svg += line(foot, {foot.x(), kTop}, kGrid);
    svg += text_at(foot.x(), foot.y() + 18.0, tick.label, "text-anchor=\"middle\"");
  }
  for (const Tick& tick : chart.log_y ? logarithmic_ticks(frame.y) : linear_ticks(frame.y)) {
    const Eigen::Vector2d foot = frame.pixel(frame.x.least, tick.at);
    svg += line(foot, {kLeft + kPlotWidth, foot.y()}, kGrid);
    svg += text_at(foot.x() - 8.0, foot.y() + 4.0, tick.label, "text-anchor=\"end\"");
  }
  svg +=
      fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"{}\"/>\n",
                  kLeft, kTop, kPlotWidth, frame.height, kFaint);
  svg += text_at(kLeft + 0.5 * kPlotWidth, kTop + frame.height + 42.0, chart.x_label, "text-anchor=\"middle\"");
  const double middle = kTop + 0.5 * frame.height;
  svg += text_at(20.0, middle, chart.y_label,
                 fmt::format("text-anchor=\"middle\" transform=\"rotate(-90 20 {:.1f})\"", middle));
  return svg;
}

// Skips points closer than half a pixel to the previous one.
std::string polyline(const std::vector<Eigen::Vector2d>& piece, const ChartSeries& series, const Chart& chart,
                     const ChartFrame& frame) {
  constexpr double kVisible = 0.5;  // pixels
  std::string points;
  Eigen::Vector2d last = Eigen::Vector2d::Constant(-1e9);
  for (const Eigen::Vector2d& point : piece) {
    if (!is_drawn(chart, point)) continue;
    const Eigen::Vector2d pixel = frame.pixel(point.x(), axis_y(chart, point.y()));
    if ((pixel - last).norm() < kVisible) continue;
    last = pixel;
    points += fmt::format("{}{:.1f},{:.1f}", points.empty() ? "" : " ", pixel.x(), pixel.y());
  }
  if (points.empty()) return "";
  return "<polyline fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke=\"" + series.colour +
         fmt::format("\" stroke-width=\"{:.1f}\" points=\"", series.width) + points + "\"/>\n";
}

std::string curves(const Chart& chart, const ChartFrame& frame) {
  std::string svg;
  for (const ChartSeries& series : chart.series) {
    for (const auto& piece : series.pieces) svg += polyline(piece, series, chart, frame);
  }
  return svg;
}

std::string legend(const Chart& chart) {
  constexpr double kY = 74.0, kSample = 24.0, kGap = 8.0, kCharacter = 7.0, kBetween = 26.0;  // pixels
  std::string svg;
  double x = kLeft;
  for (const ChartSeries& series : chart.series) {
    svg += fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"3\"/>\n", x, kY,
        x + kSample, kY, series.colour);
    svg += text_at(x + kSample + kGap, kY + 4.0, series.name);
    x += kSample + kGap + kCharacter * static_cast<double>(series.name.size()) + kBetween;
  }
  return svg;
}

double height_of(const ChartFrame& frame) {
  return kTop + frame.height + kBottom;
}

std::string svg_header(double height) {
  std::string svg =
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" ", kWidth, height);
  svg += fmt::format("viewBox=\"0 0 {:.0f} {:.0f}\" font-family=\"Helvetica, Arial, sans-serif\" ", kWidth, height);
  return svg + fmt::format("font-size=\"13\" fill=\"{}\">\n<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n", kInk,
                           kPaper);
}

std::string content(const Chart& chart, const ChartFrame& frame) {
  return text_at(kLeft, 30.0, chart.title, "font-size=\"18\" font-weight=\"bold\"") +
         text_at(kLeft, 52.0, chart.subtitle, fmt::format("fill=\"{}\"", kFaint)) + axes(chart, frame) +
         curves(chart, frame) + legend(chart);
}

constexpr const char* kEstimateColour = "#0072b2";
constexpr Timestamp kLongestStep = std::chrono::milliseconds(500);  // longer intervals between poses break the line

Timestamp longest_step(const std::vector<PosePair>& pairs) {
  if (pairs.size() < 2) return kLongestStep;
  const Timestamp mean = (pairs.back().time - pairs.front().time) / static_cast<int>(pairs.size() - 1);
  return std::max(kLongestStep, 5 * mean);
}

// The aligned estimate. Precondition: the report has an absolute error of these pairs.
std::vector<TracePoint> trace_of(const EvaluationReport& report, const std::vector<PosePair>& pairs) {
  std::vector<TracePoint> trace;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d& position = pairs[i].estimated_world_from_body.translation;
    trace.push_back({pairs[i].time, report.ate->truth_from_estimate * position, report.ate->errors[i]});
  }
  return trace;
}

Chart path_chart(const EvaluationReport& report, const std::vector<PosePair>& pairs, bool y_points_down) {
  const auto from_above = [y_points_down](const Eigen::Vector3d& position) {
    return Eigen::Vector2d(position.x(), y_points_down ? position.z() : position.y());
  };
  const auto true_point = [&](const PosePair& pair) { return from_above(pair.true_world_from_body.translation); };
  const auto estimated_point = [&](const TracePoint& point) { return from_above(point.position_in_truth); };
  const Timestamp longest = longest_step(pairs);
  Chart chart;
  chart.title = "Path from above";
  chart.subtitle = fmt::format("{} poses with truth, {:.2f} m of true path", report.pairs, report.true_path);
  chart.x_label = "x [m]";
  chart.y_label = y_points_down ? "z [m]" : "y [m]";
  chart.equal_scales = true;
  chart.series = {{"truth", kTruthColour, kTruthWidth, line_through(pairs, longest, true_point)},
                  {"estimate", kEstimateColour, 1.6, line_through(trace_of(report, pairs), longest, estimated_point)}};
  return chart;
}

Chart error_chart(const EvaluationReport& report, const std::vector<PosePair>& pairs) {
  const auto error_at = [begin = pairs.front().time](const TracePoint& point) {
    return Eigen::Vector2d(to_seconds(point.time - begin), point.error);
  };
  Chart chart;
  chart.title = "Position error over time";
  chart.subtitle =
      fmt::format("RMSE {:.4f} m, max {:.4f} m", report.ate->translation.rmse, report.ate->translation.max);
  chart.x_label = "time [s]";
  chart.y_label = "error [m]";
  chart.series = {
      {"estimate", kEstimateColour, 1.6, line_through(trace_of(report, pairs), longest_step(pairs), error_at)}};
  return chart;
}

std::string_view colour_of(Arm arm) {
  return name_among<Arm::hybrid>({"#0072b2", "#e69f00", "#c7322e"}, arm);
}

// Pixels. The hybrid's line is drawn last and is narrower, so that both stay visible where they coincide.
double width_of(Arm arm) {
  return arm == Arm::localise_only ? 3.4 : 1.6;
}

std::string shown_name(Arm arm) {
  std::string name(name_of(arm));
  std::ranges::replace(name, '_', ' ');
  return name;
}

// Horizontal axes of the truth: z points up in EuRoC, y points down in KITTI.
Eigen::Vector2d from_above(const Eigen::Vector3d& position, RecordingFormat format) {
  return {position.x(), format == RecordingFormat::kitti ? position.z() : position.y()};
}

std::string about(const CaseResult& result) {
  std::string text = result.what.recording;
  if (result.what.map) text += " on the map of " + *result.what.map;
  return text;
}

}  // namespace

std::vector<double> round_ticks(double least, double most) {
  constexpr double kMaxParts = 10.0;
  const double rough = (most - least) / kMaxParts;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough) step = factor * power;
  }
  std::vector<double> ticks;
  const auto first = static_cast<long long>(std::ceil(least / step - 1e-9));
  const auto last = static_cast<long long>(std::floor(most / step + 1e-9));
  for (long long i = first; i <= last; ++i) ticks.push_back(static_cast<double>(i) * step);
  return ticks;
}

std::string to_svg(const Chart& chart) {
  const ChartFrame frame = frame_of(chart);
  return svg_header(height_of(frame)) + content(chart, frame) + "</svg>\n";
}

std::string to_svg(const std::vector<Chart>& charts) {
  double height = 0.0;
  std::string svg;
  for (const Chart& chart : charts) {
    const ChartFrame frame = frame_of(chart);
    svg += fmt::format("<g transform=\"translate(0 {:.0f})\">\n", height) + content(chart, frame) + "</g>\n";
    height += height_of(frame);
  }
  return svg_header(height) + svg + "</svg>\n";
}

Chart path_chart(const CaseResult& result) {
  Chart chart;
  chart.title = result.what.name + ": path from above";
  chart.subtitle =
      about(result) + "; final poses; no map: aligned to the truth; others: in the frame of the offline map";
  chart.x_label = "x [m]";
  chart.y_label = result.format == RecordingFormat::kitti ? "z [m]" : "y [m]";
  chart.equal_scales = true;
  const auto of_truth = [&result](const StampedPose& sample) {
    return from_above(sample.world_from_body.translation, result.format);
  };
  const auto of_trace = [&result](const TracePoint& point) {
    return from_above(point.position_in_truth, result.format);
  };
  chart.series.push_back({"truth", kTruthColour, kTruthWidth, line_through(result.truth, kLongestStep, of_truth)});
  for (const ArmResult& arm : result.arms) {
    chart.series.push_back({shown_name(arm.arm), std::string(colour_of(arm.arm)), width_of(arm.arm),
                            line_through(arm.final_trace, kLongestStep, of_trace)});
  }
  return chart;
}

Chart error_chart(const CaseResult& result) {
  constexpr double kMillimetres = 1e3;
  Chart chart;
  chart.title = result.what.name + ": position error over time";
  chart.subtitle = about(result) + "; causal poses; no map: after alignment; others: in the frame of the offline map";
  chart.x_label = "time [s]";
  chart.y_label = "error [mm]";
  chart.log_y = true;
  const Timestamp begin = result.truth.empty() ? Timestamp{0} : result.truth.front().time;
  const auto of_trace = [begin](const TracePoint& point) {
    return Eigen::Vector2d(to_seconds(point.time - begin), kMillimetres * point.error);
  };
  for (const ArmResult& arm : result.arms) {
    chart.series.push_back({shown_name(arm.arm), std::string(colour_of(arm.arm)), width_of(arm.arm),
                            line_through(arm.causal_trace, kLongestStep, of_trace)});
  }
  return chart;
}

std::string evaluation_plot(const EvaluationReport& report, const Trajectory& estimate, const Trajectory& truth,
                            bool y_points_down) {
  const std::vector<PosePair> pairs = associate(estimate, truth, report.protocol.association);
  return to_svg({path_chart(report, pairs, y_points_down), error_chart(report, pairs)});
}

}  // namespace byre
