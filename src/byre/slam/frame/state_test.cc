#include "byre/slam/frame/state.h"

#include <ostream>

#include <gmock/gmock.h>

namespace byre {

void PrintTo(State state, std::ostream* out) {
  *out << to_string(state);
}

namespace {

struct Transition {
  State before;
  Evidence evidence;
  State after;
};

class NextState : public ::testing::TestWithParam<Transition> {};

TEST_P(NextState, FollowsTheTable) {
  EXPECT_EQ(next_state(GetParam().before, GetParam().evidence, {.lost_after = 10.0}), GetParam().after);
}

constexpr Evidence kNothing{.pose_found = false, .pose_confirmed = true, .seconds_without_pose = 1.0};
constexpr Evidence kNothingForLong{.pose_found = false, .pose_confirmed = true, .seconds_without_pose = 10.0};
constexpr Evidence kKeptPose{.pose_found = true, .pose_confirmed = true, .seconds_without_pose = 0.0};
constexpr Evidence kDoubtfulPose{.pose_found = true, .pose_confirmed = false, .seconds_without_pose = 1.0};
constexpr Evidence kDoubtfulForLong{.pose_found = true, .pose_confirmed = false, .seconds_without_pose = 10.0};

INSTANTIATE_TEST_SUITE_P(Table, NextState,
                         ::testing::Values(Transition{State::initialising, kNothing, State::initialising},
                                           Transition{State::initialising, kNothingForLong, State::initialising},
                                           Transition{State::initialising, kDoubtfulPose, State::relocalising},
                                           Transition{State::initialising, kKeptPose, State::tracking},
                                           Transition{State::tracking, kKeptPose, State::tracking},
                                           Transition{State::tracking, kNothing, State::relocalising},
                                           Transition{State::tracking, kNothingForLong, State::lost},
                                           Transition{State::relocalising, kNothing, State::relocalising},
                                           Transition{State::relocalising, kDoubtfulPose, State::relocalising},
                                           Transition{State::relocalising, kNothingForLong, State::lost},
                                           Transition{State::relocalising, kDoubtfulForLong, State::lost},
                                           Transition{State::relocalising, kKeptPose, State::tracking},
                                           Transition{State::lost, kNothing, State::lost},
                                           Transition{State::lost, kDoubtfulPose, State::lost},
                                           Transition{State::lost, kKeptPose, State::tracking}));

TEST(ToString, DistinguishesStates) {
  EXPECT_EQ(to_string(State::initialising), "initialising");
  EXPECT_EQ(to_string(State::tracking), "tracking");
  EXPECT_EQ(to_string(State::relocalising), "relocalising");
  EXPECT_EQ(to_string(State::lost), "lost");
}

struct Sight {
  OfflineEvidence evidence;
  OfflineView view;
};

class ViewOfOffline : public ::testing::TestWithParam<Sight> {};

TEST_P(ViewOfOffline, FollowsTheTable) {
  const OfflineViewOptions options{.min_inliers = 20, .min_expected = 40, .min_features = 50};
  EXPECT_EQ(view_of_offline(GetParam().evidence, options), GetParam().view);
}

INSTANTIATE_TEST_SUITE_P(
    Table, ViewOfOffline,
    ::testing::Values(
        Sight{{.expected = 300, .inliers = 20, .image_is_faulty = false, .features = 900}, OfflineView::held},
        Sight{{.expected = 300, .inliers = 20, .image_is_faulty = true, .features = 60}, OfflineView::held},
        Sight{{.expected = 300, .inliers = 19, .image_is_faulty = false, .features = 900}, OfflineView::changed},
        Sight{{.expected = 39, .inliers = 5, .image_is_faulty = false, .features = 900}, OfflineView::off_the_map},
        Sight{{.expected = 300, .inliers = 5, .image_is_faulty = true, .features = 900}, OfflineView::blinded},
        Sight{{.expected = 0, .inliers = 0, .image_is_faulty = false, .features = 49}, OfflineView::blinded}));

}  // namespace
}  // namespace byre
