#include "byre/map/driven_ground.h"

#include "byre/map/keyframe_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace byre {
namespace {

constexpr double kAround = 3.0;  // metres about a place, from which the plane there is taken

double angle_of(const Eigen::Vector3d& one, const Eigen::Vector3d& other) {
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

// The value that so large a share of all stay below.
double value_above(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + place);
  return values[static_cast<std::size_t>(place)];
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
  constexpr double kShare = 0.95;      // share of the path that must lie within both
  constexpr double kMostHeight = 0.1;  // metres
  constexpr double kMostTilt = 0.06;   // radians: who carries a camera tilts it by more
  return value_above(spread.heights, kShare) <= kMostHeight && value_above(spread.tilts, kShare) <= kMostTilt;
}

}  // namespace

// "Up" along the path is that of the bodies around, which is right on a ramp and on a slope across the way as well.
DrivingPlane DrivenGround::plane_around(const Eigen::Vector3d& position_in_map) const {
  std::vector<Eigen::Vector3d> around;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const Pose& body : path_) {
    if ((body.translation - position_in_map).squaredNorm() > kAround * kAround) continue;
    around.push_back(body.translation);
    up += body.rotation * up_in_body_;
  }
  return fit_driving_plane(std::move(around), up.normalized());
}

DrivenGround::Stand DrivenGround::stand_of(const Pose& map_from_body) const {
  const auto squared_distance = [&](const Pose& body) {
    return (body.translation - map_from_body.translation).squaredNorm();
  };
  const Pose& nearest = *std::ranges::min_element(path_, {}, squared_distance);
  const DrivingPlane plane = plane_around(nearest.translation);
  const Eigen::Vector3d from_middle = map_from_body.translation - plane.point_in_map;
  Stand stand;
  stand.distance = std::sqrt(squared_distance(nearest));
  stand.height = from_middle.dot(plane.up_in_map);
  const Eigen::Vector3d beside = from_middle - stand.height * plane.up_in_map;
  const double by_tilt = beside.dot(plane.up_information.inverse() * beside);
  stand.height_sigma = std::sqrt(std::pow(std::max(height_spread_, plane.thickness), 2) + by_tilt);
  stand.up_in_map = plane.up_in_map;
  stand.up_in_body = map_from_body.rotation.conjugate() * plane.up_in_map;
  stand.tilt = angle_of(stand.up_in_body, up_in_body_);
  stand.tilt_sigma = tilt_spread_;
  return stand;
}

// How bodies stand is found by planes that take up from the whole path; then planes take it from how bodies stand.
std::optional<DrivenGround> DrivenGround::under(const Map& map) {
  constexpr std::size_t kLeastPlaces = 20;
  constexpr double kLeastLength = 1.0;  // metres, spread of the path
  const std::optional<DrivingPlane> whole = fit_driving_plane(map);
  if (!whole || whole->path_in_map.size() < kLeastPlaces || whole->length < kLeastLength) return std::nullopt;
  DrivenGround ground;
  for (const KeyframeId id : map.keyframe_ids()) ground.path_.push_back(world_from_body(map, *map.find_keyframe(id)));
  constexpr int kRounds = 2;
  Eigen::Vector3d up_in_body = Eigen::Vector3d::Zero();
  for (const Pose& body : ground.path_) up_in_body += body.rotation.conjugate() * whole->up_in_map;
  Spread spread;
  for (int round = 0; round < kRounds; ++round) {
    ground.up_in_body_ = up_in_body.normalized();
    up_in_body.setZero();
    spread = {};
    for (const Pose& body : ground.path_) {
      const Stand stand = ground.stand_of(body);
      up_in_body += stand.up_in_body;
      spread.heights.push_back(std::abs(stand.height));
      spread.tilts.push_back(stand.tilt);
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
