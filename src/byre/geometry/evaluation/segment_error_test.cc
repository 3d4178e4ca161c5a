#include "byre/geometry/evaluation/segment_error.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

// Circles over hilly ground; the estimate has a larger scale and turns too far.
std::vector<PosePair> rounds(int count) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < count; ++i) {
    const double angle = 1.3 * i / 150.0;
    PosePair pair;
    pair.time = i * std::chrono::milliseconds(100);
    pair.true_world_from_body = {rotation_exp({0.0, 0.0, angle}),
                                 {150.0 * std::sin(angle), 150.0 * (1.0 - std::cos(angle)), 5.0 * std::sin(i / 50.0)}};
    pair.estimated_world_from_body = {
        rotation_exp({0.0, 0.0, angle + 1e-4 * i}),
        1.01 * (rotation_exp({0.0, 0.0, 5e-5 * i}) * pair.true_world_from_body.translation)};
    pairs.push_back(pair);
  }
  return pairs;
}

// Reference values: a numpy transcription of KITTI's evaluate_odometry.cpp and numpy's SVD.
TEST(SegmentErrors, MatchTheDevelopmentKit) {
  const SegmentErrors errors = segment_errors(rounds(900), 1.0);
  EXPECT_EQ(errors.all.count, 447);
  EXPECT_NEAR(errors.all.translation, 0.016562838647187918, 1e-12);
  EXPECT_NEAR(errors.all.rotation, 0.004409385256866442, 1e-9);
  ASSERT_THAT(errors.by_length, SizeIs(8));
  EXPECT_EQ(errors.by_length.front().length, 100.0);
  EXPECT_EQ(errors.by_length.front().count, 83);
  EXPECT_NEAR(errors.by_length.front().translation, 0.026121443544713165, 1e-12);
  EXPECT_EQ(errors.by_length.back().length, 800.0);
  EXPECT_EQ(errors.by_length.back().count, 29);
  EXPECT_NEAR(errors.by_length.back().translation, 0.004266401728547895, 1e-12);
  EXPECT_NEAR(errors.by_length.back().rotation, 0.004404613050068219, 1e-9);
}

TEST(SegmentErrors, ScaleTheEstimateFirst) {
  std::vector<PosePair> pairs = rounds(200);
  for (PosePair& pair : pairs) {
    pair.estimated_world_from_body = pair.true_world_from_body;
    pair.estimated_world_from_body.translation *= 0.25;
  }
  EXPECT_LT(segment_errors(pairs, 4.0).all.translation, 1e-12);
  EXPECT_GT(segment_errors(pairs, 1.0).all.translation, 0.5);
}

TEST(SegmentErrors, AreEmptyForAShortPath) {
  const SegmentErrors errors = segment_errors(rounds(70), 1.0);
  EXPECT_EQ(errors.all.count, 0);
  EXPECT_THAT(errors.by_length, IsEmpty());
  EXPECT_EQ(segment_errors({}, 1.0).all.count, 0);
}

TEST(PrincipalSpread, MatchesTheSingularValues) {
  const Eigen::Vector3d spread = principal_spread(rounds(900));
  EXPECT_NEAR(spread[0], 109.50125165711464, 1e-9);
  EXPECT_NEAR(spread[1], 99.04686125541576, 1e-9);
  EXPECT_NEAR(spread[2], 3.5044049789036764, 1e-9);
}

}  // namespace
}  // namespace byre
