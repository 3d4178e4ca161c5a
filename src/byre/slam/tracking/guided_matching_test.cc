#include "byre/slam/tracking/guided_matching.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/mission_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr Descriptor kDescriptor{0x0123456789abcdef, 0xfedcba9876543210, 0x5555aaaa5555aaaa, 0x0f0f0f0f0f0f0f0f};

// The descriptor with its lowest bits inverted.
Descriptor differing(int bits) {
  Descriptor descriptor = kDescriptor;
  for (int bit = 0; bit < bits; ++bit) descriptor[static_cast<std::size_t>(bit / 64)] ^= std::uint64_t{1} << (bit % 64);
  return descriptor;
}

ScratchVector<ExpectedPoint> expected_points(const MapView& map, const Pose& camera_from_world, const Rig& rig) {
  return project_points(map, map.online().point_ids(), camera_from_world, rig);
}

// A point on the optical axis of a camera at the world's origin, seen in octave 3.
MapPoint point_ahead(double depth) {
  MapPoint point;
  point.position_in_world = {0.0, 0.0, depth};
  point.descriptor = kDescriptor;
  point.max_distance = static_cast<float>(depth) * kScaleOfOctave[3];
  point.min_distance = point.max_distance / kScaleOfOctave.back();
  return point;
}

std::optional<Projection> project_from_origin(const MapPoint& point) {
  return project_point(point, Pose{}, Eigen::Vector3d::Zero(), simulated_rig());
}

struct CornerShape {
  Eigen::Vector2f pixel;
  Descriptor descriptor{};
  std::uint8_t octave = 0;
  float disparity = -1.0f;
};

Features make_features(const std::vector<CornerShape>& corners) {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  for (const CornerShape& corner : corners) {
    Keypoint keypoint;
    keypoint.pixel = corner.pixel;
    keypoint.octave = corner.octave;
    keypoint.disparity = corner.disparity;
    keypoints.push_back(keypoint);
    descriptors.push_back(corner.descriptor);
  }
  return Features(752, 480, std::move(keypoints), std::move(descriptors), {});
}

constexpr SearchOptions kTenPixels{.radius = 10.0f};
const Projection kAt100{{100.0, 100.0, 20.0}, 0};

TEST(ProjectPoint, PredictsPixelAndOctave) {
  const Rig rig = simulated_rig();
  const auto projection = project_from_origin(point_ahead(4.0));
  ASSERT_TRUE(projection);
  EXPECT_THAT(projection->predicted, PointNear(StereoPixel(rig.cx, rig.cy, rig.focal * rig.baseline / 4.0), 1e-9));
  EXPECT_EQ(projection->octave, 3);
}

TEST(ProjectPoint, IsEmptyBehindTheCamera) {
  MapPoint point = point_ahead(4.0);
  point.position_in_world.z() = -4.0;
  point.mean_viewing_direction = -Eigen::Vector3f::UnitZ();
  EXPECT_FALSE(project_from_origin(point));
}

TEST(ProjectPoint, IsEmptyOutsideTheImage) {
  MapPoint point = point_ahead(4.0);
  point.position_in_world.x() = 4.0;
  EXPECT_FALSE(project_from_origin(point));
}

TEST(ProjectPoint, IsEmptyIfThePointAppearsTooLargeOrTooSmall) {
  MapPoint point = point_ahead(4.0);
  point.position_in_world.z() = 2.0 * point.max_distance;
  EXPECT_FALSE(project_from_origin(point));
  point.position_in_world.z() = 0.5 * point.min_distance;
  EXPECT_FALSE(project_from_origin(point));
}

TEST(ProjectPoint, IsEmptyFromUnseenDirections) {
  MapPoint point = point_ahead(4.0);
  point.mean_viewing_direction = Eigen::Vector3f::UnitX();
  EXPECT_FALSE(project_from_origin(point));
}

TEST(ExpectedOctave, GrowsByOneForEachStepOfScale) {
  for (std::size_t octave = 0; octave < kOctaves; ++octave) {
    EXPECT_EQ(expected_octave(6.0f, 6.0f / kScaleOfOctave[octave]), static_cast<int>(octave));
  }
}

TEST(ExpectedOctave, StaysWithinThePyramid) {
  EXPECT_EQ(expected_octave(6.0f, 60.0f), 0);
  EXPECT_EQ(expected_octave(6.0f, 0.06f), kOctaves - 1);
}

TEST(FindFeature, SelectsTheMostSimilarFeatureNearby) {
  const Features features = make_features({{{95.0f, 102.0f}, differing(40)}, {{104.0f, 97.0f}, differing(10)}});
  const auto found = find_feature(features, kDescriptor, kAt100, kTenPixels);
  ASSERT_TRUE(found);
  EXPECT_EQ(features.descriptor(found->feature), differing(10));
  EXPECT_EQ(found->distance, 10);
}

TEST(FindFeature, SearchesWiderInHigherOctaves) {
  const Features features = make_features({{{115.0f, 100.0f}, kDescriptor, 4}});
  constexpr SearchOptions kEightPixels{.radius = 8.0f};  // 13.8 in octave 3, 16.6 in octave 4
  EXPECT_FALSE(find_feature(features, kDescriptor, {kAt100.predicted, 3}, kEightPixels));
  EXPECT_TRUE(find_feature(features, kDescriptor, {kAt100.predicted, 4}, kEightPixels));
}

TEST(FindFeature, SkipsCornersOfAnotherSize) {
  const Features features = make_features({{{100.0f, 100.0f}, kDescriptor, 2}});
  EXPECT_FALSE(find_feature(features, kDescriptor, kAt100, kTenPixels));
}

TEST(FindFeature, SkipsCornersAtAnotherDepth) {
  const Features features = make_features({{{100.0f, 100.0f}, kDescriptor, 0, 35.0f}});
  EXPECT_FALSE(find_feature(features, kDescriptor, kAt100, kTenPixels));
}

TEST(FindFeature, AcceptsCornersWithoutDisparity) {
  const Features features = make_features({{{100.0f, 100.0f}, kDescriptor, 0, -1.0f}});
  EXPECT_TRUE(find_feature(features, kDescriptor, kAt100, kTenPixels));
}

TEST(FindFeature, IsEmptyWithoutASimilarFeature) {
  const Features features = make_features({{{100.0f, 100.0f}, differing(kTenPixels.max_distance + 1)}});
  EXPECT_FALSE(find_feature(features, kDescriptor, kAt100, kTenPixels));
}

TEST(FindFeature, IsEmptyIfAnotherFeatureIsNearlyAsSimilar) {
  const Features features = make_features({{{95.0f, 102.0f}, differing(40)}, {{104.0f, 97.0f}, differing(39)}});
  EXPECT_FALSE(find_feature(features, kDescriptor, kAt100, kTenPixels));
}

TEST(FindFeature, TreatsOneCornerInTwoOctavesAsOne) {
  const Features features = make_features({{{95.0f, 102.0f}, differing(40), 0}, {{95.0f, 102.0f}, differing(39), 1}});
  EXPECT_TRUE(find_feature(features, kDescriptor, kAt100, kTenPixels));
}

TEST(FindFeature, IsEmptyWithoutFeatures) {
  EXPECT_FALSE(find_feature(Features(), kDescriptor, kAt100, kTenPixels));
}

TEST(MatchExpected, AssignsAFeatureToTheMostSimilarPoint) {
  const Features features = make_features({{{100.0f, 100.0f}, kDescriptor}});
  MapGraph map(Origin::online);
  MapPoint point;
  point.descriptor = differing(30);
  const PointId less_similar = map.add_point(point);
  point.descriptor = differing(5);
  const PointId more_similar = map.add_point(point);
  const std::array<ExpectedPoint, 3> expected{{{less_similar, kAt100}, {more_similar, kAt100}, {less_similar, kAt100}}};
  const auto matches = match_expected(features, MapView(nullptr, map), expected, kTenPixels);
  EXPECT_THAT(matches, ElementsAre(Field(&PointMatch::point, more_similar)));
}

TEST(MatchExpected, SkipsRemovedPoints) {
  const Features features = make_features({{{100.0f, 100.0f}, kDescriptor}});
  MapGraph map(Origin::online);
  MapPoint point;
  point.descriptor = kDescriptor;
  const PointId gone = map.add_point(point);
  map.remove_point(gone);
  const std::array<ExpectedPoint, 1> expected{{{gone, kAt100}}};
  EXPECT_THAT(match_expected(features, MapView(nullptr, map), expected, kTenPixels), IsEmpty());
}

// A frame of a mission, at its true pose on the true map.
class GuidedMatching : public ::testing::Test {
 protected:
  static constexpr std::size_t kFrame = 15;

  SimulatedMission mission_ = quarter_circle({});
  MapGraph map_ = true_map(mission_, 2, Origin::online);
  MapView view_{nullptr, map_};
  ScratchVector<ExpectedPoint> expected_ =
      expected_points(view_, true_camera_from_world(mission_, kFrame), mission_.rig);
};

TEST_F(GuidedMatching, ExpectsPointsInsideTheImageOnly) {
  ASSERT_THAT(expected_, SizeIs(::testing::Gt(100u)));
  for (const ExpectedPoint& point : expected_) EXPECT_TRUE(mission_.rig.contains(point.projection.predicted.head<2>()));
}

TEST_F(GuidedMatching, HasHighRecallAndPrecision) {
  const ScratchVector<PointMatch> matches = match_expected(*mission_.frames[kFrame].features, view_, expected_, {});
  const auto right = std::ranges::count_if(matches, [&](const PointMatch& match) {
    const int shown = mission_.landmark_of_feature[kFrame][static_cast<std::size_t>(match.feature)];
    return shown >= 0 && shown == true_landmark(mission_, map_, match.point);
  });
  EXPECT_GT(static_cast<double>(right), 0.99 * static_cast<double>(matches.size()));
  // A tenth of the points in view is not detected.
  EXPECT_GT(static_cast<double>(matches.size()), 0.8 * static_cast<double>(mission_.frames[kFrame].features->size()));
}

TEST_F(GuidedMatching, ReturnsEveryFeatureOnceInAscendingOrder) {
  const ScratchVector<PointMatch> matches = match_expected(*mission_.frames[kFrame].features, view_, expected_, {});
  EXPECT_EQ(std::ranges::adjacent_find(matches, std::greater_equal<>{}, &PointMatch::feature), matches.end());
}

}  // namespace
}  // namespace byre
