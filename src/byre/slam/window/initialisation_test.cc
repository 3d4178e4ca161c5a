#include "byre/slam/window/initialisation.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/mission_scene.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::AnyOf;
using ::testing::Each;
using ::testing::IsEmpty;

Rig one_camera() {
  Rig rig = simulated_rig();
  rig.baseline = 0.0;
  return rig;
}

SimulationOptions noisy(std::uint64_t noise_seed, double outlier_ratio = 0.0) {
  SimulationOptions options;
  options.landmarks = 5000;
  options.pixel_sigma = 0.3;
  options.noise_seed = noise_seed;
  options.outlier_ratio = outlier_ratio;
  return options;
}

// Straight path of a camera with constant heading, radians to the left of the world's x axis. step: metres per frame.
Trajectory straight_trajectory(int frames, double heading, const Eigen::Vector3d& step_in_camera) {
  const Pose ahead = turning_in_place_trajectory(1, 20.0, 0.0).front().world_from_body;
  const Eigen::Quaterniond world_from_camera = rotation_exp({0.0, 0.0, heading}) * ahead.rotation;
  Trajectory trajectory;
  for (int i = 0; i < frames; ++i) {
    trajectory.push_back({from_seconds(0.05 * i), {world_from_camera, world_from_camera * (i * step_in_camera)}});
  }
  return trajectory;
}

// Sideways motion with a corner of the room in view.
const Trajectory kSidesteps = straight_trajectory(40, 0.7, {0.03, 0.002, 0.005});

SimulatedMission sidestepping(const SimulationOptions& options) {
  return simulate_mission(one_camera(), kSidesteps, options);
}

SimulatedMission turning(const SimulationOptions& options) {
  return simulate_mission(one_camera(), turning_in_place_trajectory(100, 20.0, 0.5), options);
}

// Oblique motion towards a wall that fills the image.
SimulatedMission approaching_a_wall(SimulationOptions options) {
  options.landmarks = 12000;
  options.room_size = {6.0, 12.0, 12.0};
  return simulate_mission(one_camera(), straight_trajectory(30, 0.0, {0.03, 0.0, 0.03}), options);
}

// Attempts frame by frame up to the start.
struct Started {
  std::vector<MonocularAttempt> attempts;
  const MonocularStart* start() const { return attempts.back().start ? &*attempts.back().start : nullptr; }
  std::vector<TwoViewFailure> failures() const {
    std::vector<TwoViewFailure> failures;
    for (const MonocularAttempt& attempt : attempts) failures.push_back(attempt.failure);
    return failures;
  }
};

Started run(const SimulatedMission& mission) {
  MonocularInitialiser initialiser(mission.rig, {});
  Started started;
  for (const Frame& frame : mission.frames) {
    started.attempts.push_back(initialiser.try_start(frame));
    if (started.attempts.back().start) break;
  }
  return started;
}

Pose second_from_first(const MonocularStart& start) {
  return start.map.camera_from_world(start.second) * inverse(start.map.camera_from_world(start.first));
}

Pose true_second_from_first(const SimulatedMission& mission, const MonocularStart& start) {
  const auto frame_of = [&](KeyframeId id) { return frame_at(mission, start.map.find_keyframe(id)->frame.time); };
  return true_camera_from_world(mission, frame_of(start.second)) *
         inverse(true_camera_from_world(mission, frame_of(start.first)));
}

double angle_between_translations(const Pose& first, const Pose& second) {
  return std::acos(std::min(1.0, first.translation.normalized().dot(second.translation.normalized())));
}

// Ratios of depths in the first camera to true depths, ascending.
std::vector<double> depth_ratios(const SimulatedMission& mission, const MonocularStart& start) {
  const Keyframe& first = *start.map.find_keyframe(start.first);
  const Pose true_from_world = true_camera_from_world(mission, frame_at(mission, first.frame.time));
  std::vector<double> ratios;
  for (const PointId id : start.map.point_ids()) {
    const int landmark = true_landmark(mission, start.map, id);
    if (landmark < 0) continue;
    const double depth = (first.camera_from_world * start.map.find_point(id)->position_in_world).z();
    const Eigen::Vector3d& truth = mission.landmarks_in_world[static_cast<std::size_t>(landmark)];
    ratios.push_back(depth / (true_from_world * truth).z());
  }
  std::ranges::sort(ratios);
  return ratios;
}

// Bound on the relative depth error of nine points in ten, at their common scale.
double depth_error(const std::vector<double>& ratios) {
  const double scale = ratios[ratios.size() / 2];
  return std::max(1.0 - ratios[ratios.size() / 20] / scale, ratios[ratios.size() * 19 / 20] / scale - 1.0);
}

TEST(MonocularInitialiser, EstimatesMotionAndDepthsWithoutNoise) {
  SimulationOptions options = without_noise();
  options.landmarks = 5000;
  const SimulatedMission mission = sidestepping(options);
  const Started started = run(mission);
  ASSERT_NE(started.start(), nullptr);
  const MonocularStart& start = *started.start();
  const Pose truth = true_second_from_first(mission, start);
  EXPECT_LT(angle_between_translations(second_from_first(start), truth), 0.1 * kDegree);
  EXPECT_LT(angle_between(second_from_first(start).rotation, truth.rotation), 0.01 * kDegree);
  EXPECT_LT(depth_error(depth_ratios(mission, start)), 0.005);
}

TEST(MonocularInitialiser, IsRobustToNoiseAndOutliers) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedMission mission = sidestepping(noisy(seed, 0.3));
    const Started started = run(mission);
    ASSERT_NE(started.start(), nullptr) << "seed " << seed;
    const MonocularStart& start = *started.start();
    const Pose truth = true_second_from_first(mission, start);
    EXPECT_LT(angle_between_translations(second_from_first(start), truth), 1.0 * kDegree) << "seed " << seed;
    EXPECT_LT(angle_between(second_from_first(start).rotation, truth.rotation), 0.2 * kDegree) << "seed " << seed;
    EXPECT_LT(depth_error(depth_ratios(mission, start)), 0.2) << "seed " << seed;
  }
}

TEST(MonocularInitialiser, ReturnsAValidMapOfTwoKeyframes) {
  const SimulatedMission mission = sidestepping(noisy(1));
  const Started started = run(mission);
  ASSERT_NE(started.start(), nullptr);
  const MapGraph& map = started.start()->map;
  EXPECT_THAT(find_faults(map), IsEmpty());
  EXPECT_EQ(map.keyframe_count(), 2);
  EXPECT_GE(map.point_count(), 80);
  EXPECT_EQ(map.find_keyframe(started.start()->second)->parent, started.start()->first);
  for (const PointId id : map.point_ids()) {
    EXPECT_EQ(map.observations(id).size(), 2u);
    EXPECT_GT(map.find_point(id)->covariance.trace(), 0.0);
  }
}

TEST(MonocularInitialiser, SetsTheRequestedMedianDepth) {
  const SimulatedMission mission = sidestepping(noisy(1));
  for (const double asked : {1.0, 5.0}) {
    MonocularStartOptions options;
    options.median_depth = asked;
    MonocularInitialiser initialiser(mission.rig, options);
    std::optional<MonocularStart> start;
    for (const Frame& frame : mission.frames) {
      if (!start) start = initialiser.try_start(frame).start;
    }
    ASSERT_TRUE(start);
    std::vector<double> depths;
    for (const PointId id : start->map.point_ids()) {
      depths.push_back((start->map.camera_from_world(start->first) * start->map.find_point(id)->position_in_world).z());
    }
    std::ranges::sort(depths);
    EXPECT_NEAR(depths[depths.size() / 2], asked, 0.15 * asked);
  }
}

TEST(MonocularInitialiser, UsesTheFirstBodyFrameAsWorld) {
  Rig rig = one_camera();
  rig.body_from_camera.rotation = robot_from_camera().rotation;
  Trajectory truth = kSidesteps;
  for (StampedPose& pose : truth) pose.world_from_body = pose.world_from_body * inverse(rig.body_from_camera);
  const SimulatedMission mission = simulate_mission(rig, truth, noisy(1));
  const Started started = run(mission);
  ASSERT_NE(started.start(), nullptr);
  const Pose& first = started.start()->map.find_keyframe(started.start()->first)->camera_from_world;
  EXPECT_THAT(inverse(rig.body_from_camera * first), PoseNear(Pose{}, 1e-12, 1e-7));
}

TEST(MonocularInitialiser, RejectsATurnOnTheSpot) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Started started = run(turning(noisy(seed, 0.1)));
    ASSERT_EQ(started.attempts.size(), 100u) << "seed " << seed;
    EXPECT_EQ(started.start(), nullptr);
    const auto failures = started.failures();
    EXPECT_THAT(failures, Each(AnyOf(TwoViewFailure::too_few_matches, TwoViewFailure::rotation_only)));
    EXPECT_GT(std::ranges::count(failures, TwoViewFailure::rotation_only), 75);
  }
}

TEST(MonocularInitialiser, WaitsWhileTheCameraRests) {
  const Trajectory truth = straight_trajectory(40, 0.7, Eigen::Vector3d::Zero());
  const Started started = run(simulate_mission(one_camera(), truth, noisy(4)));
  EXPECT_EQ(started.start(), nullptr);
  EXPECT_EQ(started.attempts.front().failure, TwoViewFailure::too_few_matches);
  EXPECT_EQ(std::ranges::count(started.failures(), TwoViewFailure::rotation_only), 39);
}

TEST(MonocularInitialiser, EstimatesTheMotionOrReportsAmbiguityBeforeAWall) {
  const SimulatedMission mission = approaching_a_wall(noisy(1));
  const Started started = run(mission);
  EXPECT_GT(std::ranges::count(started.failures(), TwoViewFailure::planar_ambiguity), 0);
  if (started.start() == nullptr) return;
  const Pose truth = true_second_from_first(mission, *started.start());
  EXPECT_LT(angle_between_translations(second_from_first(*started.start()), truth), 2.0 * kDegree);
}

TEST(MonocularInitialiser, ReportsFewMatchesWithTheReference) {
  const SimulatedMission mission = sidestepping(noisy(1));
  SimulationOptions other_room = noisy(1);
  other_room.seed = 2;
  MonocularInitialiser initialiser(mission.rig, {});
  EXPECT_EQ(initialiser.try_start(mission.frames[0]).matches, 0);
  EXPECT_GT(initialiser.try_start(mission.frames[1]).matches, 200);
  const MonocularAttempt elsewhere = initialiser.try_start(sidestepping(other_room).frames[0]);
  EXPECT_EQ(elsewhere.failure, TwoViewFailure::too_few_matches);
  EXPECT_LT(elsewhere.matches, 100);
}

TEST(MonocularInitialiser, IgnoresAnEmptyFrame) {
  const SimulatedMission mission = sidestepping(noisy(1));
  MonocularInitialiser initialiser(mission.rig, {});
  const Frame empty{mission.frames[0].time, std::make_shared<const Features>()};
  for (const Frame& frame : {empty, mission.frames[0], empty, empty}) {
    EXPECT_EQ(initialiser.try_start(frame).failure, TwoViewFailure::too_few_matches);
  }
}

TEST(MonocularInitialiser, RestartsAfterAnInitialisation) {
  const SimulatedMission mission = sidestepping(noisy(1));
  MonocularInitialiser initialiser(mission.rig, {});
  std::size_t i = 0;
  while (i < mission.frames.size() && !initialiser.try_start(mission.frames[i]).start) ++i;
  ASSERT_LT(i + 1, mission.frames.size());
  EXPECT_EQ(initialiser.try_start(mission.frames[i + 1]).matches, 0);
}

TEST(MonocularInitialiser, IsDeterministic) {
  const SimulatedMission mission = sidestepping(noisy(1, 0.3));
  const Started one = run(mission), other = run(mission);
  ASSERT_TRUE(one.start() != nullptr && other.start() != nullptr);
  ASSERT_EQ(one.start()->map.point_ids(), other.start()->map.point_ids());
  for (const PointId id : one.start()->map.point_ids()) {
    EXPECT_EQ(one.start()->map.find_point(id)->position_in_world, other.start()->map.find_point(id)->position_in_world);
  }
}

// The motion between the cameras of a start, measured with a mounting that errs by a rotation about the camera's y
// axis.
TEST(MonocularStart, AgreesWithOdometryOfARightMountingOnly) {
  const SimulatedMission mission = sidestepping(noisy(1));
  const Started started = run(mission);
  ASSERT_NE(started.start(), nullptr);
  const MonocularStart& start = *started.start();
  const Pose seen = start.map.camera_from_world(start.first) * inverse(start.map.camera_from_world(start.second));
  for (const double error : {0.0, 0.05, 0.3, 3.1}) {
    const Pose turned{rotation_exp({0.0, error, 0.0}), Eigen::Vector3d::Zero()};
    const Pose measured = turned * seen * inverse(turned);
    const StartPoses odometry{Pose{}, inverse(measured)};
    EXPECT_EQ(agrees_with_odometry(start, odometry), error < 0.1) << error;
    EXPECT_NEAR(odometry_scale(start, odometry, 0.02).value(), 1.0, 1e-9) << "lengths are right with any mounting";
  }
}

}  // namespace
}  // namespace byre
