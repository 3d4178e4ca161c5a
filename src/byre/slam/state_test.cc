#include "byre/slam/state.h"

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
  EXPECT_EQ(next_state(GetParam().before, GetParam().evidence), GetParam().after);
}

constexpr Evidence kNoMap{.has_map = false, .pose_found = false};
constexpr Evidence kMapOnly{.has_map = true, .pose_found = false};
constexpr Evidence kPose{.has_map = true, .pose_found = true};

INSTANTIATE_TEST_SUITE_P(Table, NextState,
                         ::testing::Values(Transition{State::initialising, kNoMap, State::initialising},
                                           Transition{State::initialising, kMapOnly, State::initialising},
                                           Transition{State::initialising, kPose, State::tracking},
                                           Transition{State::tracking, kPose, State::tracking},
                                           Transition{State::tracking, kMapOnly, State::lost},
                                           Transition{State::tracking, kNoMap, State::initialising},
                                           Transition{State::lost, kPose, State::tracking},
                                           Transition{State::lost, kMapOnly, State::lost},
                                           Transition{State::lost, kNoMap, State::initialising}));

TEST(ToString, TellsStatesApart) {
  EXPECT_EQ(to_string(State::initialising), "initialising");
  EXPECT_EQ(to_string(State::tracking), "tracking");
  EXPECT_EQ(to_string(State::lost), "lost");
}

}  // namespace
}  // namespace byre
