#include "byre/slam/system/active_map.h"

#include <array>
#include <optional>

#include <gtest/gtest.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;

constexpr double kAccepted = 6.0;   // log-odds of the session's place
constexpr double kFarMetres = 5.0;  // outside the mapped area, from which poses are not trusted

// Eight cells along a corridor, all points of which are seen.
PlaceView convincing_view() {
  constexpr int kPoints = 30;
  PlaceView view;
  view.is_near_keyframe = true;
  for (int i = 0; i < 8; ++i) {
    view.cells.push_back(
        {{i, i % 2, 0}, kPoints, kPoints, Eigen::Vector3d(2.0 * i, 2.0 * (i % 2), 0.0), kPoints, kPoints});
  }
  return view;
}

// Frames at 10 Hz, each searched in both maps.
class ActiveMapTest : public testing::Test {
 protected:
  explicit ActiveMapTest(LinkKind kind = LinkKind::gate)
      : map_({{.kind = kind, .from = 0, .to = 1, .centre = Eigen::Vector3d(5.0, 0.0, 0.0), .radius = 1.0}}, {{}, {}},
             RegistrationOptions{}) {}

  // x: position of the session's trusted pose; empty: lost. shown: whether searches find each map.
  std::optional<std::size_t> step(std::optional<double> x, std::array<bool, 2> shown, double off_the_map = 0.0) {
    time_ += 100ms;
    if (map_.is_search_due(time_)) {
      std::array<PlaceSearch, 2> searches;
      for (std::size_t i = 0; i < shown.size(); ++i) {
        searches[i].time = time_;
        if (shown[i]) searches[i].found = FoundPlace{Pose{}, 3.0, convincing_view()};
      }
      map_.note_search(searches);
    }
    FrameReport report;
    report.time = time_;
    if (x) {
      report.map_from_body = Pose{Eigen::Quaterniond::Identity(), Eigen::Vector3d(*x, 0.0, 0.0)};
      report.health.distance_since_offline = off_the_map;
      report.health.doubt = off_the_map > kFarMetres ? DistrustReason::off_the_map : DistrustReason::none;
      report.health.verdict = off_the_map > kFarMetres ? Verdict::untrusted : Verdict::trusted;
    }
    return map_.note(report, x ? kAccepted : kNoRivals);
  }
  // Index of the map that a step changes to; empty if none of them does.
  std::optional<std::size_t> steps(int count, std::optional<double> x, std::array<bool, 2> shown,
                                   double off_the_map = 0.0) {
    std::optional<std::size_t> next;
    for (int i = 0; i < count && !next; ++i) next = step(x, shown, off_the_map);
    return next;
  }

  ActiveMap map_;
  Timestamp time_{};
};

TEST_F(ActiveMapTest, ProvesAMapAfterThreeSearchesWithoutARival) {
  EXPECT_FALSE(steps(2, 0.0, {true, false}));
  EXPECT_FALSE(map_.is_proved());
  EXPECT_FALSE(steps(2, 0.0, {true, false}));
  EXPECT_TRUE(map_.is_proved());
  EXPECT_FALSE(map_.is_search_due(time_));
}

TEST_F(ActiveMapTest, ProvesNoMapWhileAnotherExplainsTheFramesAsWell) {
  EXPECT_FALSE(steps(50, 0.0, {true, true}));
  EXPECT_FALSE(map_.is_proved());
}

TEST_F(ActiveMapTest, ChangesToTheMapFoundOnWakingUp) {
  EXPECT_EQ(steps(10, std::nullopt, {false, true}), 1U);
  EXPECT_EQ(map_.index(), 1U);
  EXPECT_FALSE(map_.is_proved());
}

TEST_F(ActiveMapTest, StaysLostWhileTwoMapsExplainTheFrames) {
  EXPECT_FALSE(steps(50, std::nullopt, {true, true}));
}

TEST_F(ActiveMapTest, IsProvedAnewAfterALossOfOneSecond) {
  steps(5, 0.0, {true, false});
  ASSERT_TRUE(map_.is_proved());
  steps(5, std::nullopt, {false, false});
  EXPECT_TRUE(map_.is_proved());
  steps(10, std::nullopt, {false, false});
  EXPECT_FALSE(map_.is_proved());
}

TEST_F(ActiveMapTest, ChangesThroughALinkOnceTheMapIsOutOfView) {
  steps(5, 0.0, {true, false});
  ASSERT_TRUE(map_.is_proved());
  EXPECT_FALSE(steps(20, 5.0, {true, true}));
  EXPECT_TRUE(map_.is_proved());
  EXPECT_EQ(steps(5, 7.0, {false, true}, 2.0), 1U);
}

TEST_F(ActiveMapTest, StaysOnAProvedMapAwayFromLinks) {
  steps(5, 0.0, {true, false});
  ASSERT_TRUE(map_.is_proved());
  EXPECT_FALSE(steps(50, 2.0, {false, true}, 2.0));
}

TEST_F(ActiveMapTest, ChangesToTheMapFoundFarOutsideTheActiveOne) {
  steps(5, 0.0, {true, false});
  ASSERT_TRUE(map_.is_proved());
  EXPECT_EQ(steps(10, 2.0, {false, true}, 6.0), 1U);
}

TEST_F(ActiveMapTest, StaysOnItsMapWhileBothAreFoundFarOutside) {
  steps(5, 0.0, {true, false});
  ASSERT_TRUE(map_.is_proved());
  EXPECT_FALSE(steps(50, 2.0, {true, true}, 6.0));
}

class LiftTest : public ActiveMapTest {
 protected:
  LiftTest() : ActiveMapTest(LinkKind::lift) {}
};

TEST_F(LiftTest, TrustsNoPoseInALiftAndBeginsAnewAfterIt) {
  steps(5, 0.0, {true, false});
  ASSERT_TRUE(map_.is_proved());
  EXPECT_FALSE(steps(20, 5.0, {true, false}));
  EXPECT_FALSE(map_.is_proved());
  EXPECT_EQ(step(7.0, {true, false}), 0U);
  EXPECT_FALSE(map_.is_proved());
}

}  // namespace
}  // namespace byre
