#include "byre/benchmark/demo/timeline.h"

#include "byre/benchmark/demo/findings_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::Not;

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// SVG path of the first line of a class.
std::string line_of(const std::string& svg, const std::string& kind) {
  const std::size_t begin = svg.find("class=\"line " + kind + "\"");
  return begin == std::string::npos ? "" : svg.substr(begin, svg.find("/>", begin) - begin);
}

TEST(DemoTimeline, DrawsABarForEachVerdictInterval) {
  DemoFindings findings = small_findings();
  findings.arms[1].moments[3].verdict = Verdict::untrusted;
  findings.arms[1].moments[5].has_pose = false;
  findings.arms[1].moments[6].has_pose = false;
  const std::string svg = demo_timeline(findings);
  EXPECT_EQ(count(svg, "class=\"trusted\""), 3 + 1);
  EXPECT_EQ(count(svg, "class=\"untrusted\""), 1);
  EXPECT_EQ(count(svg, "class=\"none\""), 1);
  EXPECT_EQ(count(svg, "class=\"degraded\""), 0);
}

TEST(DemoTimeline, DrawsBothKindsOfPointsAndTheErrorOfEachArm) {
  const std::string svg = demo_timeline(small_findings());
  for (const char* const kind : {"offline", "online", "no_map", "localise_only", "hybrid", "sigma"}) {
    EXPECT_EQ(count(line_of(svg, kind), "L"), 9) << kind;
  }
}

TEST(DemoTimeline, BreaksLinesAtGaps) {
  DemoFindings findings = small_findings();
  for (const std::size_t i : {4u, 5u}) findings.arms[1].moments[i].error.reset();
  const std::string line = line_of(demo_timeline(findings), "localise_only");
  EXPECT_EQ(count(line, "M"), 2);
  EXPECT_EQ(count(line, "L"), 6);
}

TEST(DemoTimeline, ShadesTimesOffTheMap) {
  DemoFindings findings = small_findings();
  EXPECT_EQ(count(demo_timeline(findings), "class=\"off\""), 1);
  findings.off_the_map.clear();
  EXPECT_THAT(demo_timeline(findings), Not(HasSubstr("off the map")));
}

TEST(DemoTimeline, DrawsEmptyFindings) {
  EXPECT_THAT(demo_timeline({}), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace byre
