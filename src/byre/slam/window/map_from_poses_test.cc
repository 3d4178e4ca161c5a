#include "byre/slam/window/map_from_poses.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/mission_scene.h"

#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Contains;
using testing::Each;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

// Every frames_apart-th frame of a mission; 8 cm and 2 degrees per frame.
std::vector<PosedFrame> posed_frames(const SimulatedMission& mission, std::size_t frames_apart) {
  std::vector<PosedFrame> frames;
  for (std::size_t i = 0; i < mission.frames.size(); i += frames_apart) {
    frames.push_back({mission.frames[i], true_camera_from_world(mission, i)});
  }
  return frames;
}

struct Placement {
  double right_share = 0.0;      // share of points within 5 cm of their landmark
  double mean_observations = 0;  // mean number of observations per point
};

Placement placement(const MapGraph& map, const SimulatedMission& mission) {
  double right = 0.0, observations = 0.0;
  for (const PointId id : map.point_ids()) {
    observations += static_cast<double>(map.observations(id).size());
    const int landmark = true_landmark(mission, map, id);
    if (landmark < 0) continue;
    const Eigen::Vector3d& truth = mission.landmarks_in_world[static_cast<std::size_t>(landmark)];
    right += (map.find_point(id)->position_in_world - truth).norm() < 0.05 ? 1.0 : 0.0;
  }
  return {right / map.point_count(), observations / map.point_count()};
}

TEST(MapFromPoses, KeepsTheGivenPoses) {
  const SimulatedMission mission = quarter_circle({});
  const std::vector<PosedFrame> frames = posed_frames(mission, 8);
  const MapGraph map = map_from_poses({mission.rig}, frames, {});
  EXPECT_THAT(find_faults(map), IsEmpty());
  const std::vector<KeyframeId> ids = map.keyframe_ids();
  ASSERT_THAT(ids, SizeIs(frames.size()));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Keyframe& keyframe = *map.find_keyframe(ids[i]);
    EXPECT_EQ(keyframe.camera_from_world.translation, frames[i].camera_from_world.translation);
    EXPECT_EQ(keyframe.frame.time, frames[i].frame.time);
    EXPECT_EQ(keyframe.parent.has_value(), i > 0);
  }
}

TEST(MapFromPoses, PlacesCleanPointsOnLandmarksAndRematchesThem) {
  const SimulatedMission mission = quarter_circle(without_noise());
  const MapGraph map = map_from_poses({mission.rig}, posed_frames(mission, 8), {});
  const Placement placed = placement(map, mission);
  EXPECT_GT(map.point_count(), 400);
  EXPECT_GT(placed.right_share, 0.99);
  EXPECT_GT(placed.mean_observations, 1.5);
}

// Squared normalised error of a point; infinite for an outlier.
double squared_error(const MapGraph& map, const SimulatedMission& mission, PointId id) {
  const int landmark = true_landmark(mission, map, id);
  if (landmark < 0) return std::numeric_limits<double>::infinity();
  const MapPoint& point = *map.find_point(id);
  const Eigen::Vector3d error =
      point.position_in_world - mission.landmarks_in_world[static_cast<std::size_t>(landmark)];
  return error.dot(point.covariance.ldlt().solve(error));
}

TEST(MapFromPoses, EstimatesPointCovariancesUnderNoiseAndOutliers) {
  SimulationOptions noisy;
  noisy.outlier_ratio = 0.1;
  const SimulatedMission mission = quarter_circle(noisy);
  const MapGraph map = map_from_poses({mission.rig}, posed_frames(mission, 4), {});
  constexpr double kChiSquare99 = 11.345;  // three degrees of freedom
  int confirmed = 0, right = 0;
  for (const PointId id : map.point_ids()) {
    if (map.observations(id).size() < 3) continue;
    ++confirmed;
    right += squared_error(map, mission, id) < kChiSquare99 ? 1 : 0;
  }
  EXPECT_GT(confirmed, 200);
  EXPECT_GT(right, 0.95 * confirmed);
}

TEST(MapFromPoses, ToleratesPoseErrorsOfPixels) {
  const SimulatedMission mission = quarter_circle({});
  std::vector<PosedFrame> frames = posed_frames(mission, 4);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;  // 0.15 degrees between neighbours, 1.2 pixels
    const Pose displaced_from_camera{rotation_exp({0.0, sign * 0.075 * kDegree, 0.0}), {0.0, 0.0, 0.0}};
    frames[i].camera_from_world = displaced_from_camera * frames[i].camera_from_world;
  }
  const double with_truth =
      placement(map_from_poses({mission.rig}, posed_frames(mission, 4), {}), mission).mean_observations;
  const MapGraph displaced = map_from_poses({mission.rig}, frames, {});
  EXPECT_GT(placement(displaced, mission).mean_observations, 0.9 * with_truth);
}

TEST(MapFromPoses, TriangulatesPointsOfOneCamera) {
  Rig mono = simulated_rig();
  mono.baseline = 0.0;
  const SimulatedMission mission = simulate_mission(mono, circling_trajectory(40, 10.0, 2.0, 0.25), without_noise());
  const MapGraph map = map_from_poses({mono}, posed_frames(mission, 4), {});
  EXPECT_GT(map.point_count(), 200);
  EXPECT_GT(placement(map, mission).right_share, 0.95);
  for (const PointId id : map.point_ids()) EXPECT_GE(map.observations(id).size(), 2u);
}

TEST(MapFromPoses, AcceptsOneFrameAndNone) {
  const SimulatedMission mission = quarter_circle({});
  const MapGraph one = map_from_poses({mission.rig}, {posed_frames(mission, 4).front()}, {});
  EXPECT_EQ(one.keyframe_count(), 1);
  EXPECT_GT(one.point_count(), 100);
  EXPECT_EQ(map_from_poses({mission.rig}, {}, {}).keyframe_count(), 0);
}

TEST(OverlappingKeyframes, IncludeLaterVisits) {
  const SimulatedMission lap = simulate_mission(simulated_rig(), circling_trajectory(80, 10.0, 2.0, 2.0), {});
  const MapGraph map = map_from_poses({lap.rig}, posed_frames(lap, 4), {});  // ten keyframes per lap, two laps
  const auto neighbours = overlapping_keyframes(map, {});
  ASSERT_THAT(neighbours, SizeIs(20));
  EXPECT_EQ(neighbours[0].front(), (KeyframeId{Origin::online, 10}));
  EXPECT_THAT(neighbours[0], Not(Contains(KeyframeId{Origin::online, 5})));  // opposite viewing direction
  EXPECT_THAT(neighbours, Each(Not(IsEmpty())));
}

}  // namespace
}  // namespace byre
