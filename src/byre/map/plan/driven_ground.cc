#include "byre/map/plan/driven_ground.h"

#include "byre/geometry/median.h"
#include "byre/map/keyframe_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace byre {
namespace {

constexpr double kAround = 3.0;  // metres, radius of the positions that a local plane is fitted to

double angle_of(const Eigen::Vector3d& one, const Eigen::Vector3d& other) {
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

struct Spread {
  std::vector<double> heights;
  std::vector<double> tilts;
};

bool is_of_wheels(const Spread& spread) {
  constexpr double kShare = 0.95;      // share of the path within both limits
  constexpr double kMostHeight = 0.1;  // metres
  constexpr double kMostTilt = 0.06;   // radians; hand-held cameras tilt more
  return quantile(spread.heights, kShare) <= kMostHeight && quantile(spread.tilts, kShare) <= kMostTilt;
}

std::vector<Eigen::Vector3d> places_of(const std::vector<Pose>& path) {
  std::vector<Eigen::Vector3d> places;
  places.reserve(path.size());
  for (const Pose& body : path) places.push_back(body.translation);
  return places;
}

}  // namespace

DrivenGround::DrivenGround(std::vector<Pose> path) : path_(std::move(path)), cells_(places_of(path_), kAround) {}

// Searches the whole path only if no position is within the reach of its cells.
const Pose& DrivenGround::nearest_to(const Eigen::Vector3d& position_in_map) const {
  const auto squared_distance = [&](const Pose& body) { return (body.translation - position_in_map).squaredNorm(); };
  const std::vector<std::uint32_t> near = cells_.near(position_in_map);
  const auto nearest = std::ranges::min_element(near, {}, [&](std::uint32_t i) { return squared_distance(path_[i]); });
  const bool is_within = nearest != near.end() && squared_distance(path_[*nearest]) < kAround * kAround;
  return is_within ? path_[*nearest] : *std::ranges::min_element(path_, {}, squared_distance);
}

// The up direction is the mean of the bodies nearby, which is valid on ramps and cross slopes too.
DrivingPlane DrivenGround::plane_around(const Eigen::Vector3d& position_in_map) const {
  std::vector<Eigen::Vector3d> around;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : cells_.near(position_in_map)) {
    const Pose& body = path_[i];
    if ((body.translation - position_in_map).squaredNorm() > kAround * kAround) continue;
    around.push_back(body.translation);
    up += body.rotation * up_in_body_;
  }
  return fit_driving_plane(std::move(around), up.normalized(), up_sigma_);
}

DrivenGround::GroundOffset DrivenGround::offset_from_ground(const Pose& map_from_body) const {
  const Pose& nearest = nearest_to(map_from_body.translation);
  const DrivingPlane plane = plane_around(nearest.translation);
  const Eigen::Vector3d from_middle = map_from_body.translation - plane.point_in_map;
  GroundOffset offset;
  offset.distance = (nearest.translation - map_from_body.translation).norm();
  offset.height = from_middle.dot(plane.up_in_map);
  const Eigen::Vector3d beside = from_middle - offset.height * plane.up_in_map;
  const double by_tilt = beside.dot(plane.up_information.inverse() * beside);
  offset.height_sigma = std::sqrt(std::pow(std::max(height_spread_, plane.thickness), 2) + by_tilt);
  offset.up_in_map = plane.up_in_map;
  offset.up_in_body = map_from_body.rotation.conjugate() * plane.up_in_map;
  offset.tilt = angle_of(offset.up_in_body, up_in_body_);
  offset.tilt_sigma = tilt_spread_;
  return offset;
}

// Alternates between local planes, at first by the up direction of the base or of the whole path, and the attitude of
// bodies on them.
std::optional<DrivenGround> DrivenGround::under(const MapGraph& map, const std::optional<UpInBody>& base) {
  constexpr std::size_t kLeastPlaces = 20;
  constexpr double kLeastLength = 1.0;  // metres, standard deviation along the path's longest direction
  const std::optional<DrivingPlane> whole = fit_driving_plane(map, base);
  if (!whole) return std::nullopt;
  if (!base && (whole->path_in_map.size() < kLeastPlaces || whole->length < kLeastLength)) return std::nullopt;
  std::vector<Pose> path;
  for (const KeyframeId id : map.keyframe_ids()) path.push_back(world_from_body(map, *map.keyframe_header(id)));
  DrivenGround ground(std::move(path));
  constexpr int kRounds = 2;
  Eigen::Vector3d up_in_body = Eigen::Vector3d::Zero();
  if (base) {
    up_in_body = base->up;
    ground.up_sigma_ = base->sigma;
  } else {
    for (const Pose& body : ground.path_) up_in_body += body.rotation.conjugate() * whole->up_in_map;
  }
  Spread spread;
  for (int round = 0; round < kRounds; ++round) {
    ground.up_in_body_ = up_in_body.normalized();
    up_in_body.setZero();
    spread = {};
    for (const Pose& body : ground.path_) {
      const GroundOffset offset = ground.offset_from_ground(body);
      up_in_body += offset.up_in_body;
      spread.heights.push_back(std::abs(offset.height));
      spread.tilts.push_back(offset.tilt);
    }
  }
  if (!is_of_wheels(spread)) return std::nullopt;
  constexpr double kLeastHeight = 0.005;  // metres
  constexpr double kLeastTilt = 0.003;    // radians
  ground.height_spread_ = std::max(kLeastHeight, root_mean_square(spread.heights));
  ground.tilt_spread_ = std::max(kLeastTilt, root_mean_square(spread.tilts) / std::numbers::sqrt2);
  return ground;
}

}  // namespace byre
