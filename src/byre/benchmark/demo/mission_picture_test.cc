#include "byre/benchmark/demo/animation.h"

#include "byre/benchmark/demo/findings_scene.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

class DemoPicture : public testing::Test {
 protected:
  DemoPicture() {
    place_.shown = ground_around(arms_.front().moments);
    place_.moved = {
        {{{1.0, 2.0}, {2.0, 2.0}, {2.0, 3.0}, {1.0, 3.0}}, {{-1.0, 2.0}, {0.0, 2.0}, {0.0, 3.0}, {-1.0, 3.0}}}};
  }

  DemoArm& arm(Arm wanted) { return *std::ranges::find(arms_, wanted, &DemoArm::arm); }

  // Number of positions drawn on a pane.
  static std::size_t positions(const Pane& pane, Symbol symbol) {
    std::size_t count = 0;
    for (const PictureMark& mark : pane.marks) {
      const auto* const symbols = std::get_if<PictureSymbols>(&mark);
      if (symbols != nullptr && symbols->name == "positions" && symbols->symbol == symbol)
        count += symbols->centres.size();
    }
    return count;
  }

  std::vector<DemoArm> arms_ = small_findings().arms;
  DemoPlace place_;
};

TEST_F(DemoPicture, ShowsPositionsByTheirError) {
  DemoArm& hybrid = arm(Arm::hybrid);
  hybrid.moments[1].error = 0.5;
  hybrid.moments[2].error = 5.0;
  hybrid.moments[3].position.reset();
  const Pane pane = plan_pane(place_, hybrid, 1e9, 600);
  EXPECT_EQ(positions(pane, Symbol::disc), 7U);
  EXPECT_EQ(positions(pane, Symbol::diamond), 1U);
  EXPECT_EQ(positions(pane, Symbol::cross), 1U);
}

TEST_F(DemoPicture, ShowsPositionsUpToATime) {
  const DemoArm& hybrid = arm(Arm::hybrid);
  EXPECT_EQ(positions(plan_pane(place_, hybrid, hybrid.moments[4].time_s, 600), Symbol::disc), 5U);
  EXPECT_EQ(positions(plan_pane(place_, hybrid, -1.0, 600), Symbol::disc), 0U);
}

TEST_F(DemoPicture, HatchesMovedThingsInsideTheirOutline) {
  place_.shown = {Eigen::Vector2d(-2.0, 0.0), Eigen::Vector2d(4.0, 4.0)};
  int strokes = 0;
  for (const PictureMark& mark : plan_pane(place_, {Arm::hybrid, {}, {}}, 0.0, 600).marks) {
    const auto* const line = std::get_if<PictureLine>(&mark);
    if (line == nullptr || line->points.size() != 2) continue;
    ++strokes;
    for (const Eigen::Vector2d& end : line->points) {
      EXPECT_GE(end.x(), 100.0 - 1e-6);
      EXPECT_LE(end.x(), 200.0 + 1e-6);
      EXPECT_GE(end.y(), 100.0 - 1e-6);
      EXPECT_LE(end.y(), 200.0 + 1e-6);
    }
  }
  EXPECT_GT(strokes, 10);
}

TEST_F(DemoPicture, StatesFiguresOfEachArm) {
  EXPECT_EQ(figures_line(arm(Arm::hybrid)),
            "found after 0.0 s, position 100 %, trusted 100 %, falsely trusted 0, median error 1.0 cm");
  EXPECT_THAT(figures_line(arm(Arm::no_map)), HasSubstr("never on the plan"));
  arm(Arm::hybrid).moments.clear();
  EXPECT_THAT(figures_line(arm(Arm::hybrid)), HasSubstr("never found"));
}

TEST_F(DemoPicture, ShowsAllArmsAndALegend) {
  const std::string svg = to_svg(mission_picture(place_, arms_));
  for (const Arm each : {Arm::no_map, Arm::localise_only, Arm::hybrid}) EXPECT_THAT(svg, HasSubstr(plain_name(each)));
  for (const PlanSign& sign : plan_signs()) EXPECT_THAT(svg, HasSubstr(sign.meaning));
}

TEST_F(DemoPicture, IsAnimatedInFramesOfOneSize) {
  std::vector<FrameScene> filmed(3);
  for (std::size_t i = 0; i < filmed.size(); ++i) {
    filmed[i].report.time = from_seconds(0.8 * static_cast<double>(i));
    filmed[i].left = {64, 40, std::vector<std::uint8_t>(64 * 40, 90)};
  }
  const std::vector<Picture> frames = animation_of(place_, arm(Arm::hybrid), filmed);
  ASSERT_EQ(frames.size(), 3U);
  for (const Picture& frame : frames) {
    EXPECT_EQ(frame.width, frames.front().width);
    EXPECT_EQ(frame.height, frames.front().height);
  }
  EXPECT_THAT(to_svg(frames[2]), HasSubstr("1.6 s: position trusted, true error 1.0 cm"));
}

}  // namespace
}  // namespace byre
