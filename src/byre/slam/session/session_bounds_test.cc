// Missions in which the view looks like an impossible place: behind a wall of the floor plan, or off the ground that
// the map was driven on.

#include "byre/slam/session/session_scene.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kFramesOfLap = 120;             // frames, at 10 Hz, of a circle of 2 m radius
constexpr std::size_t kFramesOnOneSide = 15;  // frames from the start, all at x > 1 m
constexpr double kWallHalfWidth = 1.05;       // metres, half width of the unmapped strip along x = 0

SimulatedMission lap_at(std::uint64_t noise_seed, double height = 0.0) {
  SimulationOptions options;
  options.noise_seed = noise_seed;
  Trajectory way = circling_trajectory(kFramesOfLap, 10.0, 2.0, 1.0);
  for (StampedPose& pose : way) pose.world_from_body.translation.z() += height;
  return simulate_mission(simulated_rig(), way, options);
}

// The lap without the strip along x = 0, so that no path of the map crosses it.
SimulatedMission parts_beside_the_wall(const SimulatedMission& lap) {
  SimulatedMission parts = lap;
  parts.truth.clear();
  parts.frames.clear();
  parts.landmark_of_feature.clear();
  for (std::size_t i = 0; i < lap.frames.size(); ++i) {
    if (std::abs(lap.truth[i].world_from_body.translation.x()) < kWallHalfWidth) continue;
    parts.truth.push_back(lap.truth[i]);
    parts.frames.push_back(lap.frames[i]);
    parts.landmark_of_feature.push_back(lap.landmark_of_feature[i]);
  }
  return parts;
}

// A plan of 20 x 20 m in the map's frame, with a wall of 0.2 m along x = 0. door: width of a gap in that wall, metres.
PlanWalls wall_across(double door = 0.0) {
  constexpr double kPixel = 0.1;  // metres
  constexpr int kSide = 200;      // pixels
  FloorPlan plan;
  plan.width = plan.height = kSide;
  plan.metres_per_pixel = kPixel * Eigen::Vector2d(1.0, -1.0).asDiagonal();
  plan.top_left_in_plan = {-9.95, 9.95};
  plan.occupied_threshold = 0.65;
  std::vector<std::int8_t> occupancy(kSide * kSide, kFreePixel);
  for (int row = 0; row < kSide; ++row) {
    const bool is_door = std::abs(plan.point_at({0, row}).y()) < 0.5 * door;
    if (is_door) continue;
    for (const int column : {99, 100}) occupancy[static_cast<std::size_t>(row * kSide + column)] = kOccupiedPixel;
  }
  // The outer walls close the ends of the wall.
  for (int i = 0; i < kSide; ++i) {
    for (const int edge : {0, kSide - 1}) {
      occupancy[static_cast<std::size_t>(i * kSide + edge)] = kOccupiedPixel;
      occupancy[static_cast<std::size_t>(edge * kSide + i)] = kOccupiedPixel;
    }
  }
  return {plan, occupancy};
}

std::shared_ptr<const OfflineMap> map_with(const SimulatedMission& visit, std::optional<PlanWalls> walls = {}) {
  MapGraph map = true_map(visit, 3, Origin::offline);
  for (const KeyframeId id : map.keyframe_ids()) {
    map.set_words(id, simulated_vocabulary().words_of(*map.find_keyframe(id)->frame.features));
  }
  std::optional<PlacedWalls> placed;
  if (walls) placed = place_walls(map, PlanRegistration{"plan.yaml", {}, 1e-6 * Matrix7::Identity()}, *walls);
  return std::make_shared<const OfflineMap>(std::move(map), simulated_vocabulary(), std::vector<SourceRecording>{},
                                            std::move(placed));
}

Session session_within(std::shared_ptr<const OfflineMap> offline, bool map_online) {
  SessionOptions options;
  options.map_online = map_online;
  return {simulated_rig(), options, SessionExecutors(make_inline_executor(), make_inline_executor()),
          simulated_vocabulary(), std::move(offline)};
}

// Some frames on one side of the room, then frames of the other side, to and fro.
std::vector<Frame> as_if_across(const SimulatedMission& lap, std::size_t frames) {
  constexpr std::size_t kToAndFro = 12;
  std::vector<Frame> seen;
  for (std::size_t i = 0; i < frames; ++i) {
    const std::size_t step = i % (2 * kToAndFro);
    const std::size_t across = kFramesOfLap / 2 + std::min(step, 2 * kToAndFro - step);
    const std::size_t place = i < kFramesOnOneSide ? i : across;
    seen.push_back({from_seconds(0.1 * static_cast<double>(i)), lap.frames[place].features});
  }
  return seen;
}

int count_refusals(const std::vector<FrameReport>& reports) {
  return static_cast<int>(std::ranges::count_if(
      reports, [](const FrameReport& report) { return report.has(SessionEvent::place_refused); }));
}

TEST(PlaceBounds, RejectALookalikePlaceBehindAWall) {
  const SimulatedMission lap = lap_at(2);
  Session session = session_within(map_with(parts_beside_the_wall(lap_at(1)), wall_across()), false);
  const auto reports = reports_of(session, as_if_across(lap, 100));
  EXPECT_EQ(reports[kFramesOnOneSide - 1].health.verdict, Verdict::trusted);
  for (std::size_t i = kFramesOnOneSide; i < reports.size(); ++i) {
    EXPECT_FALSE(reports[i].map_from_body) << i;
    EXPECT_EQ(reports[i].health.doubt, DistrustReason::behind_wall) << i;
  }
  EXPECT_EQ(count_refusals(reports), 1) << "reported once";
}

TEST(PlaceBounds, AllowAPlaceBehindAWallAfterEnoughTime) {
  const SimulatedMission lap = lap_at(2);
  Session session = session_within(map_with(parts_beside_the_wall(lap_at(1)), wall_across()), false);
  const auto reports = reports_of(session, as_if_across(lap, 150));
  EXPECT_EQ(reports.back().health.verdict, Verdict::trusted);
}

TEST(PlaceBounds, AllowAPlaceNearAHint) {
  const SimulatedMission lap = lap_at(2);
  Session session = session_within(map_with(parts_beside_the_wall(lap_at(1)), wall_across()), false);
  const std::vector<Frame> frames = as_if_across(lap, 60);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i == 20)
      session.set_initial_pose({.map_from_body = lap.truth[kFramesOfLap / 2].world_from_body, .radius = 2.0});
    const FrameReport report = session.process(frames[i]);
    if (i >= 20) {
      EXPECT_TRUE(report.map_from_body) << i;
    }
  }
}

TEST(PlaceBounds, AllowAPlaceBehindADoor) {
  const SimulatedMission lap = lap_at(2);
  Session session = session_within(map_with(parts_beside_the_wall(lap_at(1)), wall_across(1.2)), false);
  const auto reports = reports_of(session, as_if_across(lap, 60));
  EXPECT_EQ(count_refusals(reports), 0);
  EXPECT_EQ(reports.back().health.verdict, Verdict::trusted);
}

TEST(PlaceBounds, RejectRegistrationOfASubmapBehindAWall) {
  const SimulatedMission lap = lap_at(2);
  Session session = session_within(map_with(parts_beside_the_wall(lap_at(1)), wall_across()), true);
  const auto reports = reports_of(session, as_if_across(lap, 100));
  for (std::size_t i = kFramesOnOneSide; i < reports.size(); ++i) EXPECT_FALSE(reports[i].map_from_body) << i;
  EXPECT_EQ(reports.back().health.doubt, DistrustReason::not_registered);
  EXPECT_EQ(reports.back().refused_place, DistrustReason::behind_wall) << "found by the search during tracking";
  EXPECT_EQ(count_refusals(reports), 1);
}

TEST(PlaceBounds, RejectALookalikePlaceOffTheGround) {
  const SimulatedMission lifted = lap_at(2, 0.6);
  Session session = session_within(map_with(lap_at(1)), false);
  const auto reports = reports_of(session, {lifted.frames.begin(), lifted.frames.begin() + 20});
  for (const FrameReport& report : reports) {
    EXPECT_FALSE(report.map_from_body);
    EXPECT_EQ(report.health.doubt, DistrustReason::off_the_plane);
  }
  EXPECT_EQ(count_refusals(reports), 1);
}

TEST(PlaceBounds, ApplyNoGroundConstraintFromAFlownMap) {
  const SimulatedMission lifted = lap_at(2, 0.6);
  SimulationOptions options;
  const SimulatedMission flown =
      simulate_mission(simulated_rig(), figure_eight_trajectory(160, 10.0, 5.0, 1.0), options);
  Session session = session_within(map_with(flown), false);
  const auto reports = reports_of(session, lifted.frames);
  EXPECT_EQ(count_refusals(reports), 0);
  EXPECT_TRUE(std::ranges::any_of(reports, [](const FrameReport& report) { return report.map_from_body.has_value(); }));
}

TEST(PlaceBounds, ApplyNoGroundConstraintToOtherCameras) {
  const SimulatedMission lifted = lap_at(2, 0.6);
  SessionOptions options;
  options.mission.bounds.is_on_ground_of_map = false;
  Session session(simulated_rig(), options, SessionExecutors(make_inline_executor(), make_inline_executor()),
                  simulated_vocabulary(), map_with(lap_at(1)));
  const auto reports = reports_of(session, {lifted.frames.begin(), lifted.frames.begin() + 20});
  EXPECT_EQ(reports.back().health.verdict, Verdict::trusted);
}

// Largest height and tilt off the ground of a robot without features for 3 s, whose measured motion climbs and rolls.
Agreement worst_off_the_ground(bool is_planar) {
  constexpr std::size_t kDark = 20, kLight = 50;  // first frame without features, and first frame with features again
  const Rig rig = simulated_rig(robot_from_camera());
  const Trajectory way = circling_trajectory(kFramesOfLap, 10.0, 2.0, 1.0, robot_from_camera());
  SimulationOptions options;
  const auto offline = map_with(simulate_mission(rig, way, options));
  options.noise_seed = 2;
  const SimulatedMission mission = simulate_mission(rig, way, options);
  SessionOptions session_options;
  session_options.is_planar = is_planar;
  Session session(rig, session_options, SessionExecutors(make_inline_executor(), make_inline_executor()),
                  simulated_vocabulary(), offline);
  const Pose wrong = exp_pose((Vector6() << 0.0, 0.0, 0.005, 0.003, 0.0, 0.0).finished());
  Agreement worst;
  for (std::size_t i = 0; i < kLight; ++i) {
    std::optional<BodyMotion> odometry;
    if (i > 0) odometry = (inverse(way[i - 1].world_from_body) * way[i].world_from_body) * wrong;
    const FrameReport report =
        session.process(i < kDark ? mission.frames[i] : without_features(mission.frames[i]), odometry);
    if (i < kDark) continue;
    const Pose error = inverse(way[i].world_from_body) * report.map_from_body.value();
    worst.translation = std::max(worst.translation, std::abs(error.translation.z()));
    worst.rotation = std::max(worst.rotation, std::abs(rotation_log(error.rotation).x()));
  }
  return worst;
}

TEST(PlanarMotion, ConstrainsTheBodyToTheGroundWithoutFeatures) {
  const Agreement free = worst_off_the_ground(false), held = worst_off_the_ground(true);
  EXPECT_GT(free.translation, 0.1);
  EXPECT_GT(free.rotation, 0.05);
  EXPECT_LT(held.translation, 0.02);
  EXPECT_LT(held.rotation, 0.01);
}

TEST(PlanarMotion, KeepsTrackedPoses) {
  const SimulatedMission mission = lap_at(2);
  SessionOptions options;
  options.is_planar = true;
  Session session(simulated_rig(), options, SessionExecutors(make_inline_executor(), make_inline_executor()),
                  simulated_vocabulary(), map_with(lap_at(1)));
  const auto reports = reports_of(session, mission.frames);
  for (std::size_t i = 5; i < reports.size(); ++i) {
    EXPECT_EQ(reports[i].health.verdict, Verdict::trusted) << i;
    EXPECT_LT((reports[i].map_from_body->translation - mission.truth[i].world_from_body.translation).norm(), 0.03) << i;
  }
}

}  // namespace
}  // namespace byre
