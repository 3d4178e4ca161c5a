#include "byre/simulation/cowshed/feeding_robot.h"

#include "byre/simulation/pixel_rays.h"
#include "byre/simulation/seeded_draws.h"

#include <cmath>
#include <numbers>

namespace byre {
namespace {

constexpr double kStep_s = 0.005;          // time step of the travelled distance
constexpr double kOverlap = 1.0;           // metres driven beyond a full lap
constexpr double kShortestStraight = 4.0;  // metres
constexpr double kTurnOnTheSpot = 3.0;     // metres that it counts for: 6 s, at most 60 degrees a second
constexpr int kTurnSteps = 2000;

double eased(double x) {
  const double part = std::clamp(x, 0.0, 1.0);
  return part * part * (3.0 - 2.0 * part);
}

// Heading change after a part of a half turn, radians: the curvature rises from zero and falls back to it.
double turned(double part) {
  return std::numbers::pi * part - 0.5 * std::sin(2.0 * std::numbers::pi * part);
}

// Positions along a left half turn of length 1 that begins at the origin along x.
std::vector<Eigen::Vector2d> unit_turn() {
  std::vector<Eigen::Vector2d> positions{Eigen::Vector2d::Zero()};
  for (int i = 0; i < kTurnSteps; ++i) {
    const double heading = turned((i + 0.5) / kTurnSteps);
    positions.emplace_back(positions.back() + Eigen::Vector2d(std::cos(heading), std::sin(heading)) / kTurnSteps);
  }
  return positions;
}

// A sum of oscillations of random phase, about as large as amplitude.
double vibration(double time_s, double amplitude, std::uint64_t seed, std::uint64_t axis) {
  SeededDraws draws(seed, 40 + axis);
  double sum = 0.0;
  for (const float fastest : {1.6f, 3.5f, 7.0f}) {  // hertz
    const double frequency = draws.between(0.6f * fastest, fastest);
    sum += std::sin(2.0 * std::numbers::pi * (frequency * time_s + draws.between(0.0f, 1.0f))) / std::sqrt(fastest);
  }
  return 0.7 * amplitude * sum;
}

Camera robot_camera(double focal, double cx, double cy, double k1) {
  return {.model = CameraModel::radial_tangential,
          .width = 752,
          .height = 480,
          .fx = focal,
          .fy = focal * 0.9985,
          .cx = cx,
          .cy = cy,
          .distortion = {k1, 0.0781, 0.00021, -0.00012, 0.0}};
}

}  // namespace

Calibration feeding_robot_calibration(int divisor) {
  Eigen::Matrix3d body_from_level_camera;
  body_from_level_camera << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,                       //
      0.0, -1.0, 0.0;
  const Pose body_from_left{Eigen::Quaterniond(body_from_level_camera) * rotation_exp({-0.02, 0.004, 0.003}),
                            {0.35, 0.075, 0.9}};
  const Pose right_from_left{rotation_exp({0.002, -0.0035, 0.0015}), {-0.15, 0.0006, -0.0009}};
  return {
      .left = downscaled_camera(robot_camera(456.2, 371.4, 243.7, -0.2871), divisor),
      .right = StereoPartner{downscaled_camera(robot_camera(457.1, 378.9, 238.2, -0.2884), divisor), right_from_left},
      .body_from_left = body_from_left};
}

FeedingCourse::FeedingCourse(const FeedingCourseOptions& options) : options_(options), turn_(unit_turn()) {
  const double arc_length = lane_distance() / turn_.back().y();
  for (Eigen::Vector2d& position : turn_) position *= arc_length;
  turn_length_ = options.turn == TurnKind::spot ? kTurnOnTheSpot : arc_length;
  const auto laps_missed = [&](double straight, int laps) {  // metres; negative: beyond the last lap
    return laps * 2.0 * (straight + turn_length_) + kOverlap - drive(straight).back();
  };
  int laps = 1;
  while (laps_missed(options.max_straight, laps) < 0.0) ++laps;
  double shorter = kShortestStraight;
  double longer = options.max_straight;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (shorter + longer);
    (laps_missed(middle, laps) < 0.0 ? shorter : longer) = middle;
  }
  straight_ = shorter;
  travelled_ = drive(straight_);
}

// Target speed, metres per second. A robot that turns on the spot nearly stops before and after.
double FeedingCourse::target_speed(double along_half_lap, double straight) const {
  constexpr double kSlowing = 1.5;                                             // metres
  constexpr double kStopping = 0.5;                                            // metres
  constexpr double kCrawling = 0.1;                                            // metres per second
  const double to_turn = std::min(along_half_lap, straight - along_half_lap);  // negative in the turn
  const double limit = options_.turn_speed + (options_.cruise_speed - options_.turn_speed) * eased(to_turn / kSlowing);
  if (options_.turn == TurnKind::arc) return limit;
  const double in_turn = std::min(along_half_lap - straight, straight + turn_length_ - along_half_lap);
  return kCrawling + (limit - kCrawling) * eased(std::max(to_turn, in_turn) / kStopping);
}

// Distance travelled every kStep_s seconds on a lap with the given straights, metres.
std::vector<double> FeedingCourse::drive(double straight) const {
  constexpr double kStart_s = 2.5;
  const double half_lap = straight + turn_length_;
  const double first = 2.0 * half_lap * options_.start;
  const auto steps = static_cast<int>(std::ceil(options_.duration_s / kStep_s));
  std::vector<double> travelled{0.0};
  for (int i = 0; i < steps; ++i) {
    const double along = std::fmod(first + travelled.back(), half_lap);
    const double speed = target_speed(along, straight);
    travelled.push_back(travelled.back() + kStep_s * speed * eased((i + 0.5) * kStep_s / kStart_s));
  }
  return travelled;
}

double FeedingCourse::travelled(double time_s) const {
  const double step = std::clamp(time_s / kStep_s, 0.0, static_cast<double>(travelled_.size() - 1));
  const auto before = std::min(static_cast<std::size_t>(step), travelled_.size() - 2);
  const double part = step - static_cast<double>(before);
  return (1.0 - part) * travelled_[before] + part * travelled_[before + 1];
}

FeedingCourse::PathPoint FeedingCourse::turn_point(double along_turn) const {
  const double step = std::clamp(along_turn / turn_length_, 0.0, 1.0) * kTurnSteps;
  const auto before = std::min(static_cast<std::size_t>(step), turn_.size() - 2);
  const double part = step - static_cast<double>(before);
  return {(1.0 - part) * turn_[before] + part * turn_[before + 1], turned(step / kTurnSteps)};
}

// The second half of a lap is the first one rotated by 180 degrees about the centre of the course.
FeedingCourse::PathPoint FeedingCourse::path_point(double along_lap) const {
  const double half_lap = straight_ + turn_length_;
  const double along = std::fmod(along_lap, half_lap);
  const bool is_returning = std::fmod(along_lap, 2.0 * half_lap) >= half_lap;
  PathPoint point{{along, 0.0}, 0.0};
  if (along > straight_) {
    point = turn_point(along - straight_);
    point.position.x() += straight_;
  }
  point.position -= Eigen::Vector2d(0.5 * straight_, 0.5 * lane_distance());
  if (is_returning) point = {-point.position, point.heading + std::numbers::pi};
  point.position += Eigen::Vector2d(far_x() - 0.5 * straight_, options_.shift_y);
  return point;
}

Pose FeedingCourse::world_from_body(double time_s) const {
  constexpr double kTilt = 0.005;    // radians
  constexpr double kBounce = 0.002;  // metres
  const double way = travelled(time_s);
  const PathPoint point = path_point(lap_length() * options_.start + way);
  const double driving = eased(way / 0.5);  // no vibration at standstill
  const auto shake = [&](double amplitude, std::uint64_t axis) {
    return driving * vibration(time_s, amplitude, options_.seed, axis);
  };
  const Eigen::Quaterniond rotation = rotation_exp({0.0, 0.0, point.heading + shake(0.2 * kTilt, 3)}) *
                                      rotation_exp({shake(kTilt, 0), shake(kTilt, 1), 0.0});
  return {rotation, {point.position.x(), point.position.y(), shake(kBounce, 2)}};
}

}  // namespace byre
