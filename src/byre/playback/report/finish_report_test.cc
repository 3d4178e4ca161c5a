#include "byre/playback/report/map_report.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using nlohmann::json;
using testing::HasSubstr;

FinishResult finishing_with_two_loops() {
  FinishResult finishing;
  finishing.report.loops = 2;
  finishing.report.loop_drifts = {7.25, 12.0};
  finishing.report.loop_residuals = {0.004, 0.0105};
  finishing.report.keyframes_removed = 3;
  finishing.report.points_removed = 40;
  finishing.report.before = {50, 4000, 20000, 0.5, 2.0, 2};
  finishing.report.after = {47, 3960, 19000, 0.25, 1.5, 1};
  finishing.seconds = 1.25;
  return finishing;
}

TEST(FinishText, ContainsChangesAndFaults) {
  const std::string text = to_text(finish_report(finishing_with_two_loops()), true);
  EXPECT_THAT(text, HasSubstr("last loops   2 closed; drift 7.2, 12.0 px, residual 0.004, 0.011 m\n"));
  EXPECT_THAT(text, HasSubstr("removed      3 redundant keyframes, 40 weak points\n"));
  EXPECT_THAT(text, HasSubstr("pixel error  median 0.500 -> 0.250 px, 95 % within 2.000 -> 1.500 px\n"));
  EXPECT_THAT(text, HasSubstr("parts        2 -> 1 without common points\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("faults")));
}

TEST(FinishText, ReportsNoLoopsAndInterruption) {
  FinishResult finishing;
  finishing.cut_short = true;
  finishing.faults = {"point online 7 is not observed by any keyframe",
                      "point online 8 is not observed by any keyframe"};
  const std::string text = to_text(finish_report(finishing), true);
  EXPECT_THAT(text, HasSubstr("last loops   none\n"));
  EXPECT_THAT(text, HasSubstr("faults       2; the first: point online 7 is not observed by any keyframe\n"));
  EXPECT_THAT(text, HasSubstr("finishing    interrupted after 0.0 s; continue with \"byre refine\"\n"));
}

TEST(FinishJson, ContainsTheSameFigures) {
  const json report = finish_report(finishing_with_two_loops()).figures;
  EXPECT_EQ(report.at("loops"), 2);
  EXPECT_EQ(report.at("loop_residuals_m"), (json{0.004, 0.0105}));
  EXPECT_EQ(report.at("before").at("parts"), 2);
  EXPECT_EQ(report.at("after").at("reprojection_p95_px"), 1.5);
  EXPECT_EQ(report.at("keyframes_removed"), 3);
  EXPECT_EQ(report.at("faults"), json::array());
  EXPECT_EQ(report.at("cut_short"), false);
}

}  // namespace
}  // namespace byre
