#include "byre/slam/upkeep/replay.h"

#include "byre/geometry/degrees.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

std::shared_ptr<const Features> measured_features(const Keyframe& keyframe, const Rig& rig) {
  const Features& features = *keyframe.frame.features;
  std::vector<Keypoint> keypoints(features.keypoints().begin(), features.keypoints().end());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const Sighting& sighting = keyframe.sightings[i];
    if (sighting.point && rig.contains(sighting.pixel.cast<double>())) keypoints[i].pixel = sighting.pixel;
  }
  return std::make_shared<const Features>(features.moved(std::move(keypoints)));
}

// Cube, and the axis nearest to the viewing direction.
std::array<int, 4> place_of(const ReplayFrame& frame) {
  constexpr double kSide = 4.0;  // metres
  const Pose world_from_camera = inverse(frame.camera_from_world);
  const Eigen::Vector3d direction = world_from_camera.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d along = (world_from_camera.translation / kSide).array().max(-1e6).min(1e6).floor();
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  const int main_direction = 2 * static_cast<int>(axis) + (direction[axis] > 0.0 ? 1 : 0);
  return {static_cast<int>(along.x()), static_cast<int>(along.y()), static_cast<int>(along.z()), main_direction};
}

// Largest change of a pose that is no fault. sigma: of the pose before; least: change that is never a fault; certain:
// sigma above which the pose was uncertain.
double largest_change(double sigma, double least, double certain) {
  return sigma <= certain ? std::max(least, sigma) : std::min(1.5 * sigma, 3.0 * certain);
}

// Poses known to 20 mm and 0.3 degrees may change by their standard deviation, others by 1.5 times as much, at most by
// 60 mm and 0.9 degrees.
std::string fault_of(const PlaceProof& place, double least_inliers) {
  if (place.found_after < place.found_before) {
    return fmt::format("{} of {} frames are found instead of {}", place.found_after, place.frames, place.found_before);
  }
  if (place.inliers_after < least_inliers * place.inliers_before) {
    return fmt::format("{} points fit instead of {}", place.inliers_after, place.inliers_before);
  }
  if (place.shift > largest_change(place.shift_sigma, 0.005, 0.02)) {
    return fmt::format("poses move by {:.1f} mm", 1e3 * place.shift);
  }
  if (place.turn > largest_change(place.turn_sigma, 0.05 * kDegree, 0.3 * kDegree)) {
    return fmt::format("poses turn by {:.3f} degrees", place.turn / kDegree);
  }
  return {};
}

}  // namespace

std::vector<ReplayFrame> frames_to_replay(const MapGraph& map) {
  std::vector<ReplayFrame> frames;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    if (!keyframe.frame.features) continue;
    ReplayFrame& frame = frames.emplace_back();
    frame.frame.time = keyframe.frame.time;
    frame.rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
    frame.frame.features = measured_features(keyframe, frame.rig);
    frame.camera_from_world = keyframe.camera_from_world;
    frame.covariance = keyframe.covariance;
  }
  return frames;
}

std::vector<Replayed> replay(std::span<const ReplayFrame> frames, const MapGraph& map, const PlaceIndex& index) {
  const MapView view(map);
  // Comparisons weigh poses by their covariance.
  const LocaliseOptions options{.max_position_sigma = 0.05, .max_rotation_sigma = 0.05};
  std::vector<Replayed> results;
  for (const ReplayFrame& frame : frames) {
    const Localisation found = localise(frame.frame, frame.rig, view, index, options);
    Replayed& result = results.emplace_back();
    if (!found.tracked) continue;
    result.camera_from_world = found.tracked->camera_from_world;
    result.covariance = found.tracked->match_covariance;
    result.inliers = static_cast<int>(found.tracked->features.size());
  }
  return results;
}

bool is_elsewhere(const ReplayFrame& frame, const Replayed& found) {
  constexpr double kMaxShift = 0.1;  // metres
  constexpr double kMaxTurn = 1.0 * kDegree;
  constexpr double kSigmas = 3.0;  // a mission drifts where the map shows little
  if (!found.camera_from_world) return false;
  const Pose change = frame.camera_from_world * inverse(*found.camera_from_world);
  const Matrix6 covariance = frame.covariance + found.covariance;
  const double shift_sigma = std::sqrt(position_variance(covariance));
  const double turn_sigma = std::sqrt(rotation_variance(covariance));
  return change.translation.norm() > std::max(kMaxShift, kSigmas * shift_sigma) ||
         rotation_log(change.rotation).norm() > std::max(kMaxTurn, kSigmas * turn_sigma);
}

std::vector<PlaceProof> compare_places(std::span<const ReplayFrame> frames, std::span<const Replayed> before,
                                       std::span<const Replayed> after, double least_inliers) {
  std::map<std::array<int, 4>, std::vector<std::size_t>> by_place;
  for (std::size_t i = 0; i < frames.size(); ++i) by_place[place_of(frames[i])].push_back(i);
  std::vector<PlaceProof> places;
  for (const auto& [key, members] : by_place) {
    PlaceProof place;
    place.frames = static_cast<int>(members.size());
    Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();  // sums
    Matrix6 covariance = Matrix6::Zero();                                             // sum
    int both = 0;
    for (const std::size_t i : members) {
      place.centre_in_map += inverse(frames[i].camera_from_world).translation / place.frames;
      const bool is_found_before = before[i].camera_from_world && !is_elsewhere(frames[i], before[i]);
      const bool is_found_after = after[i].camera_from_world && !is_elsewhere(frames[i], after[i]);
      place.found_before += is_found_before;
      place.found_after += is_found_after;
      if (!is_found_before || !is_found_after) continue;
      ++both;
      place.inliers_before += before[i].inliers;
      place.inliers_after += after[i].inliers;
      const Pose was = inverse(*before[i].camera_from_world), is = inverse(*after[i].camera_from_world);
      shift += is.translation - was.translation;
      turn += rotation_log(is.rotation * was.rotation.conjugate());
      covariance += before[i].covariance;
    }
    if (both > 0) {
      place.shift = shift.norm() / both;
      place.turn = turn.norm() / both;
      place.shift_sigma = std::sqrt(position_variance(covariance) / both);
      place.turn_sigma = std::sqrt(rotation_variance(covariance) / both);
    }
    place.fault = fault_of(place, least_inliers);
    places.push_back(std::move(place));
  }
  return places;
}

}  // namespace byre
