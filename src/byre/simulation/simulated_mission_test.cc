#include "byre/simulation/simulated_mission_scene.h"

#include "byre/features/descriptor.h"
#include "byre/geometry/geometry_matchers.h"

#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::SizeIs;

SimulationOptions without_noise() {
  SimulationOptions options;
  options.pixel_sigma = 0.0;
  options.disparity_sigma = 0.0;
  options.missing_ratio = 0.0;
  options.descriptor_flip_ratio = 0.0;
  return options;
}

Trajectory short_circle() {
  return circling_trajectory(20, 10.0, 2.0, 0.25, robot_from_camera());
}

SimulatedMission simulate(const SimulationOptions& options) {
  return simulate_mission(simulated_rig(robot_from_camera()), short_circle(), options);
}

struct Seen {
  Keypoint keypoint;
  Descriptor descriptor{};
  int landmark = -1;
  Eigen::Vector3d point_in_camera;
};

std::vector<Seen> all_features(const SimulatedMission& mission) {
  std::vector<Seen> all;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const Features& features = *mission.frames[i].features;
    const Pose camera_from_world = inverse(mission.truth[i].world_from_body * mission.rig.body_from_camera);
    for (int feature = 0; feature < features.size(); ++feature) {
      Seen seen{features.keypoint(feature), features.descriptor(feature),
                mission.landmark_of_feature[i][static_cast<std::size_t>(feature)], Eigen::Vector3d::Zero()};
      if (seen.landmark >= 0) {
        seen.point_in_camera = camera_from_world * mission.landmarks_in_world[static_cast<std::size_t>(seen.landmark)];
      }
      all.push_back(seen);
    }
  }
  return all;
}

double root_mean_square(const std::vector<double>& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(values.size()));
}

TEST(SimulateMission, PlacesFeaturesAtTrueProjections) {
  const SimulatedMission mission = simulate(without_noise());
  for (const Seen& seen : all_features(mission)) {
    ASSERT_GE(seen.landmark, 0);
    ASSERT_GT(seen.point_in_camera.z(), 0.0);
    const StereoPixel expected = mission.rig.project(seen.point_in_camera);
    EXPECT_THAT(seen.keypoint.pixel.cast<double>(), PointNear(expected.head<2>(), 1e-3));
    if (!seen.keypoint.has_disparity()) continue;
    EXPECT_NEAR(seen.keypoint.disparity, expected.z(), 1e-3);
  }
}

TEST(SimulateMission, HasEnoughFeaturesInEveryFrame) {
  for (const Frame& frame : simulate({}).frames) EXPECT_GT(frame.features->size(), 80);
}

TEST(SimulateMission, HasConsistentTimesAndSizes) {
  const SimulatedMission mission = simulate({});
  ASSERT_EQ(mission.frames.size(), mission.truth.size());
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    EXPECT_EQ(mission.frames[i].time, mission.truth[i].time);
    EXPECT_THAT(mission.landmark_of_feature[i], SizeIs(mission.frames[i].features->keypoints().size()));
  }
}

TEST(SimulateMission, PlacesLandmarksOnTheSurfacesOfTheRoom) {
  SimulationOptions options;
  options.room_size = {4.0, 6.0, 2.0};
  for (const Eigen::Vector3d& landmark : simulate(options).landmarks_in_world) {
    const Eigen::Array3d from_wall = options.room_size.array() / 2.0 - landmark.array().abs();
    EXPECT_NEAR(from_wall.minCoeff(), 0.0, 1e-12);
  }
}

TEST(SimulateMission, AssignsDescriptorsAndHigherOctavesToNearLandmarks) {
  const SimulatedMission mission = simulate(without_noise());
  std::map<int, std::vector<Seen>> views;
  for (const Seen& seen : all_features(mission)) views[seen.landmark].push_back(seen);
  for (const auto& [landmark, seen] : views) {
    const Seen& first = seen.front();
    const Seen& last = seen.back();
    EXPECT_EQ(first.descriptor, last.descriptor);
    const double times_nearer = first.point_in_camera.norm() / last.point_in_camera.norm();
    const double octaves = std::log(times_nearer) / std::log(kOctaveScale);
    EXPECT_NEAR(last.keypoint.octave - first.keypoint.octave, octaves, 1.0);
  }
}

TEST(SimulateMission, UsesAllOctaves) {
  std::set<int> octaves;
  for (const Seen& seen : all_features(simulate({}))) octaves.insert(seen.keypoint.octave);
  EXPECT_THAT(octaves, SizeIs(kOctaves));
}

TEST(SimulateMission, RotatesAnglesWithTheCamera) {
  const Rig rig = simulated_rig();
  Trajectory rolling = turning_in_place_trajectory(2, 1.0, 0.0);
  constexpr double kRoll = 0.3;
  rolling[1].world_from_body.rotation = rolling[1].world_from_body.rotation * rotation_exp({0.0, 0.0, kRoll});
  const SimulatedMission mission = simulate_mission(rig, rolling, without_noise());

  std::map<int, std::vector<float>> angles;
  std::vector<double> turns;
  for (const Seen& seen : all_features(mission)) {
    const bool is_near_axis = seen.point_in_camera.head<2>().norm() < 0.3 * seen.point_in_camera.z();
    if (is_near_axis) angles[seen.landmark].push_back(seen.keypoint.angle);
  }
  for (const auto& [landmark, both] : angles) {
    if (both.size() == 2) turns.push_back(std::remainder(both[0] - both[1], 2.0 * std::numbers::pi));
  }
  ASSERT_GT(turns.size(), 20u);
  EXPECT_NEAR(std::accumulate(turns.begin(), turns.end(), 0.0) / static_cast<double>(turns.size()), kRoll, 0.02);
}

TEST(SimulateMission, DisturbsPixelsAndDisparitiesByTheirSigmas) {
  const SimulationOptions options;
  const SimulatedMission mission = simulate(options);
  std::vector<double> columns, rows, disparities;
  for (const Seen& seen : all_features(mission)) {
    const StereoPixel expected = mission.rig.project(seen.point_in_camera);
    const double scale = kScaleOfOctave[seen.keypoint.octave];
    columns.push_back((seen.keypoint.pixel.x() - expected.x()) / scale);
    rows.push_back((seen.keypoint.pixel.y() - expected.y()) / scale);
    if (!seen.keypoint.has_disparity()) continue;
    disparities.push_back((seen.keypoint.disparity - expected.z()) / seen.keypoint.disparity_sigma);
    EXPECT_FLOAT_EQ(seen.keypoint.disparity_sigma, static_cast<float>(options.disparity_sigma * scale));
  }
  ASSERT_GT(columns.size(), 2000u);
  EXPECT_NEAR(root_mean_square(columns), options.pixel_sigma, 0.03);
  EXPECT_NEAR(root_mean_square(rows), options.pixel_sigma, 0.03);
  EXPECT_NEAR(root_mean_square(disparities), 1.0, 0.06);
}

TEST(SimulateMission, FlipsDescriptorBitsByTheirRatio) {
  SimulationOptions options;
  options.descriptor_flip_ratio = 0.1;
  const std::vector<Seen> noisy = all_features(simulate(options));
  std::map<int, Descriptor> true_descriptors;
  for (const Seen& seen : all_features(simulate(without_noise()))) true_descriptors[seen.landmark] = seen.descriptor;
  double flipped = 0.0;
  for (const Seen& seen : noisy) flipped += hamming_distance(seen.descriptor, true_descriptors.at(seen.landmark));
  EXPECT_NEAR(flipped / (256.0 * static_cast<double>(noisy.size())), 0.1, 0.005);
}

TEST(SimulateMission, MissesLandmarksByTheirRatio) {
  SimulationOptions options = without_noise();
  const auto all = static_cast<double>(all_features(simulate(options)).size());
  options.missing_ratio = 0.25;
  EXPECT_NEAR(static_cast<double>(all_features(simulate(options)).size()) / all, 0.75, 0.03);
}

TEST(SimulateMission, MarksAndDisplacesOutliers) {
  SimulationOptions options = without_noise();
  std::map<Descriptor, int> true_landmarks;
  for (const Seen& seen : all_features(simulate(options))) true_landmarks[seen.descriptor] = seen.landmark;
  options.outlier_ratio = 0.2;
  const std::vector<Seen> features = all_features(simulate(options));
  double outliers = 0.0;
  for (const Seen& seen : features) {
    outliers += seen.landmark < 0 ? 1.0 : 0.0;
    EXPECT_TRUE(true_landmarks.contains(seen.descriptor)) << "an outlier looks like a landmark";
  }
  EXPECT_NEAR(outliers / static_cast<double>(features.size()), 0.2, 0.03);
}

TEST(SimulateMission, OmitsDisparitiesOfFarLandmarksAndWithoutBaseline) {
  SimulationOptions options = without_noise();
  options.min_disparity = 12.0;
  const SimulatedMission stereo = simulate(options);
  for (const Seen& seen : all_features(stereo)) {
    EXPECT_EQ(seen.keypoint.has_disparity(), stereo.rig.project(seen.point_in_camera).z() >= 12.0);
  }
  Rig mono_rig = simulated_rig();
  mono_rig.baseline = 0.0;
  options.min_disparity = 0.0;
  for (const Seen& seen : all_features(simulate_mission(mono_rig, short_circle(), options))) {
    EXPECT_FALSE(seen.keypoint.has_disparity());
  }
}

TEST(SimulateMission, KeepsTheStrongestFeatures) {
  SimulationOptions options = without_noise();
  const SimulatedMission all = simulate(options);
  options.max_features = 40;
  const SimulatedMission few = simulate(options);
  std::vector<float> responses;
  for (const Keypoint& keypoint : all.frames[0].features->keypoints()) responses.push_back(keypoint.response);
  std::ranges::sort(responses, std::greater<>{});
  ASSERT_EQ(few.frames[0].features->size(), 40);
  for (const Keypoint& keypoint : few.frames[0].features->keypoints()) EXPECT_GE(keypoint.response, responses[39]);
}

bool are_equal(const SimulatedMission& first, const SimulatedMission& second) {
  const std::vector<Seen> a = all_features(first);
  const std::vector<Seen> b = all_features(second);
  return std::ranges::equal(a, b, [](const Seen& x, const Seen& y) {
    return x.keypoint.pixel == y.keypoint.pixel && x.keypoint.disparity == y.keypoint.disparity &&
           x.descriptor == y.descriptor && x.landmark == y.landmark;
  });
}

TEST(SimulateMission, DependsOnTheSeedsOnly) {
  SimulationOptions options;
  const SimulatedMission mission = simulate(options);
  EXPECT_TRUE(are_equal(mission, simulate(options)));
  options.noise_seed = 2;
  const SimulatedMission second_visit = simulate(options);
  EXPECT_FALSE(are_equal(mission, second_visit));
  EXPECT_EQ(mission.landmarks_in_world, second_visit.landmarks_in_world);
  options.seed = 2;
  EXPECT_NE(mission.landmarks_in_world, simulate(options).landmarks_in_world);
}

TEST(TrueMap, IsValidAndTrue) {
  const SimulatedMission mission = simulate({});
  const MapGraph map = true_map(mission, 5, Origin::offline);
  EXPECT_THAT(find_faults(map), IsEmpty());
  EXPECT_EQ(map.keyframe_count(), 4);
  EXPECT_GT(map.point_count(), 150);
  for (const PointId id : map.point_ids()) {
    EXPECT_THAT(mission.landmarks_in_world, Contains(map.find_point(id)->position_in_world));
  }
  const std::vector<KeyframeId> keyframes = map.keyframe_ids();
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const Pose world_from_body = inverse(map.camera_from_world(keyframes[i])) * inverse(mission.rig.body_from_camera);
    EXPECT_THAT(world_from_body, PoseNear(mission.truth[5 * i].world_from_body, 1e-9, 1e-6));
  }
}

TEST(TrueMap, AttachesEveryKeyframeToThePreviousOne) {
  const MapGraph map = true_map(simulate({}), 5, Origin::online);
  const std::vector<KeyframeId> keyframes = map.keyframe_ids();
  EXPECT_EQ(map.find_keyframe(keyframes.front())->parent, std::nullopt);
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    EXPECT_EQ(map.find_keyframe(keyframes[i])->parent, keyframes[i - 1]);
  }
}

TEST(TrueMap, HasTheDistanceRangeOfEachPoint) {
  const SimulatedMission mission = simulate(without_noise());
  const MapGraph map = true_map(mission, 5, Origin::online);
  for (const PointId id : map.point_ids()) {
    const MapPoint& point = *map.find_point(id);
    for (const Observation& observation : map.observations(id)) {
      const double distance = (map.camera_from_world(observation.keyframe) * point.position_in_world).norm();
      EXPECT_GT(distance, point.min_distance / kOctaveScale);
      EXPECT_LT(distance, point.max_distance * kOctaveScale);
    }
  }
}

TEST(TrueMap, OmitsOutliersAndUnobservablePoints) {
  Rig mono_rig = simulated_rig();
  mono_rig.baseline = 0.0;
  SimulationOptions options;
  options.outlier_ratio = 0.3;
  const MapGraph map =
      true_map(simulate_mission(mono_rig, circling_trajectory(20, 10.0, 2.0, 0.25), options), 5, Origin::online);
  EXPECT_THAT(find_faults(map), IsEmpty());
  for (const PointId id : map.point_ids()) EXPECT_GE(map.observations(id).size(), 2u);
}

}  // namespace
}  // namespace byre
