#include "byre/slam/tracking/tracking.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/measurement.h"
#include "byre/slam/tracking/mission_scene.h"

#include <map>
#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAreArray;
using ::testing::Ge;
using ::testing::IsEmpty;
using ::testing::Le;
using ::testing::SizeIs;

constexpr std::size_t kFrame = 21;  // between two keyframes

Pose displaced(const Pose& camera_from_world, const Eigen::Vector3d& metres, const Eigen::Vector3d& radians) {
  Vector6 delta;
  delta << metres, radians;
  return exp_pose(delta) * camera_from_world;
}

// A second visit to a room with a true map of the first visit.
class TrackingOnATrueMap : public ::testing::Test {
 protected:
  static SimulatedMission visit(std::uint64_t noise_seed, double outlier_ratio = 0.0) {
    SimulationOptions options;
    options.noise_seed = noise_seed;
    options.outlier_ratio = outlier_ratio;
    return quarter_circle(options);
  }

  std::optional<TrackedFrame> track_from(const Pose& predicted, const SimulatedMission& mission,
                                         const TrackOptions& options = {}) const {
    return track(mission.frames[kFrame], predicted, mission.rig, view_, map_.point_ids(), options);
  }

  SimulatedMission mapped_ = visit(1);
  SimulatedMission second_ = visit(2);
  MapGraph map_ = true_map(mapped_, 4, Origin::online);
  MapView view_{nullptr, map_};
  Pose truth_ = true_camera_from_world(second_, kFrame);
  Pose rough_ = displaced(truth_, {0.03, -0.02, 0.03}, {0.01, -0.015, 0.01});
};

TEST_F(TrackingOnATrueMap, EstimatesThePoseFromARoughPrediction) {
  const auto tracked = track_from(rough_, second_);
  ASSERT_TRUE(tracked);
  EXPECT_THAT(tracked->camera_from_world, PoseNear(truth_, 0.015, 0.2 * kDegree));
}

TEST_F(TrackingOnATrueMap, IsExactOnCleanFeatures) {
  const SimulatedMission clean = quarter_circle(without_noise());
  const auto tracked = track_from(rough_, clean);
  ASSERT_TRUE(tracked);
  EXPECT_THAT(tracked->camera_from_world, PoseNear(truth_, 1e-4, 1e-4));
}

TEST_F(TrackingOnATrueMap, SearchesWiderForAWrongPrediction) {
  const Pose far_off = displaced(truth_, {0.0, 0.0, 0.0}, {0.0, 5.0 * kDegree, 0.0});
  TrackOptions narrow_only;
  narrow_only.wide_radius = narrow_only.search_radius;
  EXPECT_FALSE(track_from(far_off, second_, narrow_only));
  const auto tracked = track_from(far_off, second_);
  ASSERT_TRUE(tracked);
  EXPECT_THAT(tracked->camera_from_world, PoseNear(truth_, 0.015, 0.2 * kDegree));
}

TEST_F(TrackingOnATrueMap, DistinguishesOutliersFromInliers) {
  const SimulatedMission disturbed = visit(3, 0.3);
  const auto tracked = track_from(rough_, disturbed);
  ASSERT_TRUE(tracked);
  EXPECT_THAT(tracked->camera_from_world, PoseNear(truth_, 0.02, 0.3 * kDegree));
  const auto wrong = std::ranges::count_if(tracked->features, [&](const TrackedFeature& feature) {
    return disturbed.landmark_of_feature[kFrame][static_cast<std::size_t>(feature.feature)] !=
           true_landmark(mapped_, map_, feature.point);
  });
  EXPECT_LE(static_cast<double>(wrong), 0.02 * static_cast<double>(tracked->features.size()));
}

TEST_F(TrackingOnATrueMap, CountsExpectedAndMatchedPointsAndInliers) {
  const auto tracked = track_from(rough_, second_);
  ASSERT_TRUE(tracked);
  EXPECT_GE(tracked->expected, tracked->matches);
  EXPECT_GE(tracked->matches, static_cast<int>(tracked->features.size()));
  EXPECT_GE(static_cast<int>(tracked->features.size()), TrackOptions{}.min_inliers);
}

TEST_F(TrackingOnATrueMap, ReturnsInliersAndOutliersWithTheirPoints) {
  const SimulatedMission disturbed = visit(3, 0.3);
  const auto tracked = track_from(rough_, disturbed);
  ASSERT_TRUE(tracked);
  EXPECT_FALSE(tracked->outliers.empty());
  EXPECT_EQ(tracked->features.size() + tracked->outliers.size(), static_cast<std::size_t>(tracked->matches));
  std::vector<SeenPoint> seen;
  append_seen_points(*tracked, seen);
  ASSERT_EQ(seen.size(), static_cast<std::size_t>(tracked->matches));
  EXPECT_TRUE(seen.front().is_inlier);
  EXPECT_EQ(seen.front().point, tracked->features.front().point);
  EXPECT_FALSE(seen.back().is_inlier);
  EXPECT_EQ(seen.back().pixel, tracked->outliers.back().pixel);
}

TEST_F(TrackingOnATrueMap, ReturnsFeaturesOnceInAscendingOrder) {
  const auto tracked = track_from(rough_, second_);
  ASSERT_TRUE(tracked);
  EXPECT_EQ(std::ranges::adjacent_find(tracked->features, std::greater_equal<>{}, &TrackedFeature::feature),
            tracked->features.end());
}

TEST_F(TrackingOnATrueMap, SelectsTheKeyframeWithMostCommonPoints) {
  const auto tracked = track_from(rough_, second_);
  ASSERT_TRUE(tracked);
  std::map<KeyframeId, int> shared;
  for (const TrackedFeature& feature : tracked->features) {
    for (const Observation& seen : map_.observations(feature.point)) ++shared[seen.keyframe];
  }
  for (const auto& [keyframe, count] : shared) EXPECT_LE(count, shared[tracked->reference]);
}

TEST_F(TrackingOnATrueMap, SkipsRemovedCandidates) {
  const std::vector<PointId> candidates = map_.point_ids();
  for (std::size_t i = 0; i < candidates.size(); i += 3) map_.remove_point(candidates[i]);
  const auto tracked = track(second_.frames[kFrame], rough_, second_.rig, view_, candidates, {});
  ASSERT_TRUE(tracked);
  EXPECT_THAT(tracked->camera_from_world, PoseNear(truth_, 0.02, 0.3 * kDegree));
}

TEST_F(TrackingOnATrueMap, IsEmptyInAnotherRoom) {
  SimulationOptions options;
  options.seed = 99;
  EXPECT_FALSE(track_from(truth_, quarter_circle(options)));
}

TEST_F(TrackingOnATrueMap, IsEmptyWithoutFeatures) {
  const Frame blinded{second_.frames[kFrame].time, std::make_shared<const Features>()};
  EXPECT_FALSE(track(blinded, truth_, second_.rig, view_, map_.point_ids(), {}));
}

TEST_F(TrackingOnATrueMap, IsEmptyWithoutCandidates) {
  EXPECT_FALSE(track(second_.frames[kFrame], truth_, second_.rig, view_, {}, {}));
}

TEST_F(TrackingOnATrueMap, IsEmptyIfThePredictionFacesAway) {
  EXPECT_FALSE(track_from(displaced(truth_, {0.0, 0.0, 0.0}, {0.0, 90.0 * kDegree, 0.0}), second_));
}

// The squared normalised pose error is chi-square distributed with six degrees of freedom: 6 on average.
TEST(Track, ReturnsAConsistentCovariance) {
  SimulationOptions options;
  options.pixel_sigma = corner_measurement(Keypoint{}).sigma;
  const SimulatedMission mission = quarter_circle(options);
  const MapGraph map = true_map(quarter_circle(without_noise()), 4, Origin::online);
  const MapView view(nullptr, map);
  double mean = 0.0;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const Pose truth = true_camera_from_world(mission, i);
    const auto tracked = track(mission.frames[i], truth, mission.rig, view, map.point_ids(), {});
    ASSERT_TRUE(tracked);
    const Vector6 error = log_pose(tracked->camera_from_world * inverse(truth));
    mean += error.dot(tracked->covariance.ldlt().solve(error)) / static_cast<double>(mission.frames.size());
  }
  EXPECT_THAT(mean, AllOf(Ge(4.0), Le(9.0)));
}

TEST_F(TrackingOnATrueMap, EstimatesThePoseFromAKeyframeWithoutPrediction) {
  const KeyframeId keyframe{Origin::online, kFrame / 4};
  const auto pose = pose_from_keyframe(second_.frames[kFrame], second_.rig, view_, keyframe);
  ASSERT_TRUE(pose);
  EXPECT_THAT(*pose, PoseNear(truth_, 0.3, 3.0 * kDegree));
  const auto tracked = track_from(*pose, second_);
  ASSERT_TRUE(tracked);
  EXPECT_THAT(tracked->camera_from_world, PoseNear(truth_, 0.015, 0.2 * kDegree));
}

TEST_F(TrackingOnATrueMap, IsEmptyForAKeyframeOfAnotherRoom) {
  SimulationOptions options;
  options.seed = 99;
  const SimulatedMission elsewhere = quarter_circle(options);
  EXPECT_FALSE(pose_from_keyframe(elsewhere.frames[kFrame], elsewhere.rig, view_, {Origin::online, kFrame / 4}));
}

TEST_F(TrackingOnATrueMap, IsEmptyForAMissingKeyframe) {
  EXPECT_FALSE(pose_from_keyframe(second_.frames[kFrame], second_.rig, view_, {Origin::online, 1000}));
  EXPECT_FALSE(pose_from_keyframe(second_.frames[kFrame], second_.rig, view_, {Origin::offline, 0}));
}

TEST_F(TrackingOnATrueMap, IsEmptyForAFrameWithoutFeatures) {
  const Frame blinded{second_.frames[kFrame].time, std::make_shared<const Features>()};
  EXPECT_FALSE(pose_from_keyframe(blinded, second_.rig, view_, {Origin::online, kFrame / 4}));
}

TEST_F(TrackingOnATrueMap, LocalPointsIncludeTheMostCovisibleKeyframes) {
  const KeyframeId reference{Origin::online, 4};
  std::set<PointId> expected;
  const auto insert_points_of = [&](KeyframeId id) {
    for (const Sighting& sighting : map_.find_keyframe(id)->sightings) {
      if (sighting.point) expected.insert(*sighting.point);
    }
  };
  insert_points_of(reference);
  for (const Covisible& neighbour : map_.covisible_keyframes(reference, 2)) insert_points_of(neighbour.keyframe);
  EXPECT_THAT(local_points(view_, reference, 3), ElementsAreArray(expected));
}

TEST_F(TrackingOnATrueMap, LocalPointsOfAnUnknownKeyframeAreEmpty) {
  EXPECT_THAT(local_points(view_, {Origin::online, 1000}, 10), IsEmpty());
}

}  // namespace
}  // namespace byre
