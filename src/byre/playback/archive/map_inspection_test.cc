#include "byre/playback/archive/map_inspection.h"

#include "byre/map/stored_map_scene.h"
#include "byre/simulation/simulated_mission_scene.h"

#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

constexpr double kRadius = 2.0;  // metres
constexpr double kPixelSigma = 0.5;

// One circle in a room of 10 x 8 x 4 m.
StoredMap simulated_map(int keyframes = 60) {
  SimulationOptions options;
  options.pixel_sigma = kPixelSigma;
  const auto mission = simulate_mission(simulated_rig(), circling_trajectory(keyframes, 10.0, kRadius, 1.0), options);
  StoredMap stored = StoredMapScene().stored();
  stored.map = true_map(mission, 1, Origin::offline);
  return stored;
}

TEST(Inspect, CountsTheContentsOfTheMap) {
  const StoredMapScene scene(4, 9);  // keyframes: three observe 8 points, the fourth 8 others, a fifth has no features
  const MapInspection inspection = inspect(scene.stored());
  EXPECT_EQ(inspection.counts.keyframes, 5);
  EXPECT_EQ(inspection.counts.keyframes_with_words, 2);
  EXPECT_EQ(inspection.counts.features, 36);
  EXPECT_EQ(inspection.counts.patches, 4 * 5);
  EXPECT_EQ(inspection.counts.points, 16);
  EXPECT_EQ(inspection.counts.observations, 32);
  EXPECT_EQ(inspection.observations_per_point.mean, 2.0);
  EXPECT_EQ(inspection.observations_per_point.max, 3.0);
  EXPECT_THAT(inspection.faults, IsEmpty());
}

TEST(Inspect, MeasuresSimulatedErrors) {
  const MapInspection inspection = inspect(simulated_map());
  const ReprojectionErrors& errors = inspection.errors;
  EXPECT_EQ(errors.behind_camera, 0);
  EXPECT_EQ(errors.pixel.count, inspection.counts.observations);
  EXPECT_GT(errors.disparity.count, 0);
  EXPECT_LE(errors.disparity.count, errors.pixel.count);
  // The median of a Rayleigh distribution is 1.18 sigmas; features of coarser octaves have up to 3.6 times the sigma.
  EXPECT_GT(errors.pixel.p50, 1.18 * kPixelSigma);
  EXPECT_LT(errors.pixel.p50, 3.6 * 1.18 * kPixelSigma);
  EXPECT_LT(errors.pixel.p50, errors.pixel.p95);
  EXPECT_LT(errors.pixel.p95, errors.pixel.p99);
  EXPECT_LE(errors.pixel.p99, errors.pixel.max);
}

TEST(Inspect, FindsPointsBehindTheirCameras) {
  StoredMap stored = simulated_map(4);
  const PointId id = stored.map.point_ids().front();
  MapPoint point = *stored.map.find_point(id);
  const KeyframeId observer = stored.map.observations(id).front().keyframe;
  point.position_in_world = inverse(stored.map.camera_from_world(observer)) * Eigen::Vector3d(0.0, 0.0, -1.0);
  stored.map.update_point(id, point);
  const MapInspection inspection = inspect(stored);
  EXPECT_GE(inspection.errors.behind_camera, 1);
  EXPECT_EQ(inspection.errors.pixel.count, inspection.counts.observations - inspection.errors.behind_camera);
}

TEST(Inspect, MeasuresExtentAndPath) {
  const MapInspection inspection = inspect(simulated_map());
  const Eigen::Vector3d size = inspection.points_in_world.sizes();
  EXPECT_TRUE(size.isApprox(Eigen::Vector3d(10.0, 8.0, 4.0), 0.05)) << size.transpose();
  EXPECT_NEAR(inspection.path_length, 2.0 * std::numbers::pi * kRadius, 0.3);
}

TEST(Inspect, AcceptsAnEmptyMap) {
  const MapInspection inspection = inspect({});
  EXPECT_TRUE(inspection.points_in_world.isEmpty());
  EXPECT_EQ(inspection.errors.pixel.count, 0);
  EXPECT_THAT(inspection.faults, IsEmpty());
}

}  // namespace
}  // namespace byre
