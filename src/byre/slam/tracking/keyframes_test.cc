#include "byre/slam/tracking/keyframes.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/measurement.h"
#include "byre/slam/tracking/mission_scene.h"

#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;

TrackedFeature sighted(int feature, PointId point) {
  return {feature, point, Eigen::Vector2f::Zero(), 1.0f};
}

TrackedFrame tracked_on(int points) {
  TrackedFrame tracked;
  for (int i = 0; i < points; ++i) {
    tracked.features.push_back(sighted(i, {Origin::online, static_cast<std::uint32_t>(i)}));
  }
  return tracked;
}

const KeyframeOptions kOptions;

// A frame long after the last keyframe, with the same view: no reason for another keyframe.
const KeyframeEvidence kCalm{.fresh_inliers = 400, .frames_since_last = 10};

struct Decision {
  const char* name;
  int tracked = 0;
  KeyframeEvidence evidence;
  bool wanted = false;
};

KeyframeEvidence calm_but(void (*change)(KeyframeEvidence&)) {
  KeyframeEvidence evidence = kCalm;
  change(evidence);
  return evidence;
}

void PrintTo(const Decision& decision, std::ostream* out) {
  *out << decision.name;
}

class NeedsKeyframe : public ::testing::TestWithParam<Decision> {};

TEST_P(NeedsKeyframe, FollowsTheTable) {
  const Decision& decision = GetParam();
  EXPECT_EQ(needs_keyframe(tracked_on(decision.tracked), decision.evidence, kOptions), decision.wanted);
}

INSTANTIATE_TEST_SUITE_P(
    When, NeedsKeyframe,
    ::testing::Values(
        Decision{"NothingHasChanged", 400, kCalm, false}, Decision{"AThirdOfThePointsIsLost", 250, kCalm, true},
        Decision{"FewPointsAreLeft", 90, calm_but([](auto& e) { e.fresh_inliers = 100; }), true},
        Decision{"TheCameraHasTurned", 400, calm_but([](auto& e) { e.turn = 1.1 * kOptions.max_turn; }), true},
        Decision{"TheCameraHasTurnedALittle", 400, calm_but([](auto& e) { e.turn = 0.9 * kOptions.max_turn; }), false},
        Decision{"TheCameraHasMoved", 400, calm_but([](auto& e) { e.shift_share = 1.1 * kOptions.max_shift_share; }),
                 true},
        Decision{"TheCameraHasMovedALittle", 400,
                 calm_but([](auto& e) { e.shift_share = 0.9 * kOptions.max_shift_share; }), false},
        Decision{"TheLastIsTooRecent", 250, calm_but([](auto& e) { e.frames_since_last = 1; }), false},
        Decision{"TheLastIsRecentButTrackingIsAboutToFail", 90, calm_but([](auto& e) { e.frames_since_last = 1; }),
                 true},
        Decision{"ADepthWillComeSoon", 250, calm_but([](auto& e) { e.without_depth = kMaxWaitForDepth; }), false},
        Decision{"ADepthWillComeSoonButTrackingIsAboutToFail", 90, calm_but([](auto& e) { e.without_depth = 1; }),
                 true},
        Decision{"DepthsNoLongerCome", 250, calm_but([](auto& e) { e.without_depth = kMaxWaitForDepth + 1; }), true},
        Decision{"MappingIsOneShortOfItsLimit", 250, calm_but([](auto& e) { e.pending = kMaxPending - 1; }), true},
        Decision{"MappingIsBehind", 250, calm_but([](auto& e) { e.pending = kMaxPending; }), false},
        Decision{"MappingIsBehindAndTrackingIsAboutToFail", 90, calm_but([](auto& e) { e.pending = kMaxPending; }),
                 true},
        Decision{"MappingIsFarBehindAndTrackingIsAboutToFail", 90,
                 calm_but([](auto& e) { e.pending = kMaxPendingWhenWeak; }), false}),
    [](const auto& tested) { return tested.param.name; });

TEST(MedianDepth, IsTheDepthOfTrackedPointsAlongTheOpticalAxis) {
  MapGraph map(Origin::online);
  TrackedFrame tracked;
  tracked.camera_from_world = {rotation_exp({0.0, 0.0, 0.3}), {0.0, 0.0, 1.0}};
  for (const double depth : {9.0, 2.0, 3.0}) {
    MapPoint point;
    point.position_in_world = {5.0, 0.0, depth};
    tracked.features.push_back(sighted(0, map.add_point(point)));
  }
  EXPECT_DOUBLE_EQ(median_depth(tracked, MapView(nullptr, map)), 4.0);
}

TEST(MedianDepth, SkipsRemovedPoints) {
  MapGraph map(Origin::online);
  EXPECT_EQ(median_depth(tracked_on(3), MapView(nullptr, map)), 0.0);
}

TEST(MakeKeyframe, KeepsTrackedMeasurements) {
  const SimulatedMission mission = quarter_circle({});
  TrackedFrame tracked;
  tracked.camera_from_world = true_camera_from_world(mission, 5);
  tracked.reference = {Origin::online, 3};
  const PointId point{Origin::online, 77};
  tracked.features.push_back({4, point, {12.0f, 34.0f}, 0.25f});

  const Keyframe keyframe = make_keyframe(mission.frames[5], tracked, 2);
  EXPECT_EQ(keyframe.parent, tracked.reference);
  EXPECT_EQ(keyframe.rig, 2);
  EXPECT_THAT(keyframe.camera_from_world, PoseNear(tracked.camera_from_world, 1e-12, 1e-7));
  ASSERT_EQ(static_cast<int>(keyframe.sightings.size()), mission.frames[5].features->size());
  EXPECT_EQ(keyframe.sightings[4].point, point);
  EXPECT_EQ(keyframe.sightings[4].pixel, Eigen::Vector2f(12.0f, 34.0f));
  EXPECT_EQ(keyframe.sightings[4].pixel_sigma, 0.25f);
  EXPECT_EQ(keyframe.sightings[5].point, std::nullopt);
  EXPECT_EQ(keyframe.sightings[5].pixel, mission.frames[5].features->keypoint(5).pixel);
}

TEST(InitialiseStereo, PlacesEveryPointNearItsLandmark) {
  const SimulatedMission mission = quarter_circle(without_noise());
  const auto map = initialise_stereo(mission.frames[0], mission.rig, 50);
  ASSERT_TRUE(map);
  EXPECT_THAT(find_faults(*map), IsEmpty());
  EXPECT_EQ(map->point_count(), mission.frames[0].features->size());
  for (const PointId id : map->point_ids()) {
    const int landmark = true_landmark(mission, *map, id);
    const Eigen::Vector3d landmark_in_first_camera =
        true_camera_from_world(mission, 0) * mission.landmarks_in_world[static_cast<std::size_t>(landmark)];
    EXPECT_THAT(map->find_point(id)->position_in_world, PointNear(landmark_in_first_camera, 1e-3));
  }
}

TEST(InitialiseStereo, UsesTheFirstBodyFrameAsWorld) {
  const Rig rig = simulated_rig(robot_from_camera());
  const SimulatedMission mission =
      simulate_mission(rig, circling_trajectory(2, 10.0, 2.0, 0.01, robot_from_camera()), {});
  const auto map = initialise_stereo(mission.frames[0], rig, 50);
  ASSERT_TRUE(map);
  const Keyframe& first = *map->find_keyframe({Origin::online, 0});
  EXPECT_THAT(inverse(rig.body_from_camera * first.camera_from_world), PoseNear(Pose{}, 1e-12, 1e-7));
  EXPECT_EQ(first.parent, std::nullopt);
}

TEST(InitialiseStereo, IsEmptyForTooFewDisparities) {
  Rig mono = simulated_rig();
  mono.baseline = 0.0;
  const SimulatedMission mission = simulate_mission(mono, circling_trajectory(2, 10.0, 2.0, 0.01), {});
  EXPECT_FALSE(initialise_stereo(mission.frames[0], mono, 1));
  EXPECT_FALSE(initialise_stereo({{}, std::make_shared<const Features>()}, mono, 1));
}

TEST(InitialiseStereo, RejectsDisparitiesBelowTheirNoise) {
  SimulationOptions options;
  options.disparity_sigma = 20.0;
  EXPECT_FALSE(initialise_stereo(quarter_circle(options).frames[0], simulated_rig(), 20));
}

TEST(AddStereoPoints, SkipsFeaturesWithAPoint) {
  const SimulatedMission mission = quarter_circle({});
  auto map = initialise_stereo(mission.frames[0], mission.rig, 50);
  ASSERT_TRUE(map);
  const int points = map->point_count();
  EXPECT_GT(points, 50);
  EXPECT_EQ(add_stereo_points(*map, {Origin::online, 0}), 0);
  EXPECT_EQ(map->point_count(), points);
}

// Many measurements of one point by an oblique camera, as features of one keyframe.
class ManyMeasurementsOfOnePoint : public ::testing::Test {
 protected:
  static constexpr int kMeasurements = 4000;

  void SetUp() override {
    const Rig rig = simulated_rig();
    const StereoPixel true_pixel = rig.project(camera_from_world_ * point_in_world_);
    std::mt19937_64 random(5);
    std::normal_distribution<double> noise;
    Keypoint keypoint;
    keypoint.pixel = true_pixel.head<2>().cast<float>();
    keypoint.octave = 2;
    keypoint.disparity_sigma = 0.4f;
    const double sigma = reference_sigma(Features(rig.width, rig.height, {keypoint}, {{}}, {}), 0);
    std::vector<Keypoint> keypoints;
    for (int i = 0; i < kMeasurements; ++i) {
      keypoint.pixel = (true_pixel.head<2>() + sigma * Eigen::Vector2d(noise(random), noise(random))).cast<float>();
      keypoint.disparity = static_cast<float>(true_pixel.z() + keypoint.disparity_sigma * noise(random));
      keypoints.push_back(keypoint);
    }
    Keyframe keyframe;
    keyframe.frame.features = std::make_shared<const Features>(
        rig.width, rig.height, keypoints, std::vector<Descriptor>(keypoints.size()), std::vector<Patch>{});
    keyframe.camera_from_world = camera_from_world_;
    keyframe.rig = map_.add_rig(rig);
    ASSERT_EQ(add_stereo_points(map_, map_.add_keyframe(keyframe)), kMeasurements);
  }

  const Pose camera_from_world_{rotation_exp({0.4, -0.8, 0.3}), {0.5, -0.2, 0.1}};
  const Eigen::Vector3d point_in_world_ = inverse(camera_from_world_) * Eigen::Vector3d(1.0, 0.6, 3.0);
  MapGraph map_{Origin::online};
};

TEST_F(ManyMeasurementsOfOnePoint, ScatterByTheirCovariance) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d predicted = Eigen::Matrix3d::Zero();
  for (const PointId id : map_.point_ids()) {
    mean += map_.find_point(id)->position_in_world / kMeasurements;
    predicted += map_.find_point(id)->covariance.cast<double>() / kMeasurements;
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const PointId id : map_.point_ids()) {
    const Eigen::Vector3d error = map_.find_point(id)->position_in_world - mean;
    scatter += error * error.transpose() / kMeasurements;
  }
  EXPECT_THAT(mean, PointNear(point_in_world_, 0.01));
  EXPECT_LT((scatter - predicted).norm(), 0.1 * scatter.norm());
  EXPECT_NEAR(scatter.determinant() / predicted.determinant(), 1.0, 0.2);  // checks the precise directions as well
}

TEST_F(ManyMeasurementsOfOnePoint, HaveTheDistanceRangeOfTheirOctaves) {
  const double distance = (camera_from_world_ * point_in_world_).norm();
  for (const PointId id : map_.point_ids()) {
    const MapPoint& point = *map_.find_point(id);
    EXPECT_GT(point.max_distance, distance);
    EXPECT_LT(point.min_distance, distance);
    EXPECT_NEAR(point.max_distance / point.min_distance, kScaleOfOctave.back(), 1e-4);
  }
}

}  // namespace
}  // namespace byre
