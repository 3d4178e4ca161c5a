#include "byre/slam/upkeep/stored_session.h"

#include "byre/geometry/rectified_change.h"
#include "byre/health.h"
#include "byre/slam/window/online_copy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>

namespace byre {
namespace {

// The newest recording by a camera of this size; nullptr without one.
const SourceRecording* recording_like(const StoredMap& map, const Calibration& calibration) {
  const auto is_like = [&](const SourceRecording& recording) {
    return recording.calibration.left.width == calibration.left.width &&
           recording.calibration.left.height == calibration.left.height;
  };
  const auto found = std::find_if(map.recordings.rbegin(), map.recordings.rend(), is_like);
  return found == map.recordings.rend() ? nullptr : &*found;
}

// Root-mean-square change of pixels and disparities between two calibrations, as a share of the focal length. The mean
// of u and v is left out, which acts like a rotation.
double calibration_difference(Calibration one, Calibration other) {
  constexpr int kGrid = 8;
  if (!one.right || !other.right) {
    one.right.reset();
    other.right.reset();
  }
  one.depth.reset();
  other.depth.reset();
  const RectifiedChange change(one, other);
  const double disparity = one.right ? 5.0 : 0.0;  // pixels
  std::vector<StereoPixel> moves;
  StereoPixel mean = StereoPixel::Zero();
  for (int row = 1; row < kGrid; ++row) {
    for (int column = 1; column < kGrid; ++column) {
      const StereoPixel pixel(one.left.width * column / static_cast<double>(kGrid),
                              one.left.height * row / static_cast<double>(kGrid), disparity);
      moves.push_back(change({pixel}).pixel - pixel);
      mean += moves.back() / ((kGrid - 1) * (kGrid - 1));
    }
  }
  mean.z() = 0.0;  // disparities do not act like a rotation
  double sum = 0.0;
  for (const StereoPixel& move : moves) sum += (move - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(moves.size())) / change.rig().focal;
}

// map_from_body of the keyframes.
std::vector<Pose> mapped_poses(const MapGraph& map) {
  std::vector<Pose> mapped;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Rig& rig = map.rigs()[static_cast<std::size_t>(map.rig_of(id))];
    mapped.push_back(inverse(rig.body_from_camera * map.keyframe_header(id)->camera_from_world));
  }
  return mapped;
}

bool is_mapped(const Pose& map_from_body, std::span<const Pose> mapped) {
  constexpr double kNear = 1.5;     // metres
  constexpr double kMaxTurn = 0.6;  // radians
  return std::ranges::any_of(mapped, [&](const Pose& known) {
    return (known.translation - map_from_body.translation).norm() <= kNear &&
           angle_between(known.rotation, map_from_body.rotation) <= kMaxTurn;
  });
}

struct CountedPoses {
  int on_map = 0;
  int trusted = 0;
};

// Poses at places that the map shows. Others may be untrusted, because the robot was outside.
CountedPoses count_on_map(std::span<const PoseRecord> poses, const MapGraph& map) {
  const std::vector<Pose> mapped = mapped_poses(map);
  CountedPoses count;
  for (const PoseRecord& pose : poses) {
    const bool is_on_map = is_mapped(pose.map_from_body, mapped);
    count.on_map += is_on_map;
    count.trusted += is_on_map && pose.verdict == static_cast<std::uint8_t>(Verdict::trusted);
  }
  return count;
}

}  // namespace

std::string fault_of(const StoredSession& session, const StoredMap& map, std::span<const std::uint64_t> maps) {
  constexpr double kMaxDifference = 0.005;  // share of the focal length: 2 pixels of 400
  constexpr double kMaxUntrusted = 0.8;     // share of the poses on the map; sightings count at accepted places only
  constexpr int kFirst = 10;                // poses before a place is confirmed
  const SessionRecord& record = session.record;
  if (std::ranges::find(maps, record.map_id) == maps.end()) {
    return "ran on another map (" + to_text(record.map_id) + ") than this one and the versions it was made of";
  }
  const Calibration& calibration = session.stored.recordings.back().present_calibration();
  const SourceRecording* const known = recording_like(map, calibration);
  if (known == nullptr) return "has images of another size than the map's recordings";
  const double difference = calibration_difference(known->present_calibration(), calibration);
  if (!(difference <= kMaxDifference)) {
    return fmt::format("has another calibration than the map: pixels differ by {:.2f} % of the focal length",
                       1e2 * difference);
  }
  const auto [on_map, trusted] = count_on_map(record.poses, map.map);
  if (on_map == 0) return "was never on the map";
  if (trusted == 0 || on_map - trusted > std::max<double>(kFirst, kMaxUntrusted * on_map)) {
    return fmt::format("has a trusted pose in {} of {} frames on the map only", trusted, on_map);
  }
  return {};
}

SessionPlace place_of(std::span<const ReplayFrame> frames, std::span<const Replayed> found, const MapGraph& map) {
  constexpr int kLeastFound = 2;
  constexpr double kLeastShare = 0.1;    // share of the frames at places that the map shows
  constexpr double kMaxElsewhere = 0.2;  // share of the frames found; one is never enough
  constexpr int kRun = 3;                // successive frames found with the same shift
  constexpr double kSameShift = 0.2;     // metres
  const std::vector<Pose> mapped = mapped_poses(map);
  SessionPlace place;
  place.frames = static_cast<int>(frames.size());
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // shift of the last frame found, metres
  int run = 0, longest = 0, on_map = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Pose map_from_camera = inverse(frames[i].camera_from_world);
    const bool is_on_map = is_mapped(map_from_camera * inverse(frames[i].rig.body_from_camera), mapped);
    on_map += is_on_map;
    if (!found[i].camera_from_world) continue;
    const bool is_away = is_elsewhere(frames[i], found[i]);
    if (is_away && !is_on_map) continue;  // keyframes outside the map may be found at places that look alike
    ++place.found;
    const Eigen::Vector3d before = shift;
    shift = inverse(*found[i].camera_from_world).translation - map_from_camera.translation;
    place.elsewhere += is_away;
    run = !is_away ? 0 : (shift - before).norm() <= kSameShift ? run + 1 : 1;
    longest = std::max(longest, run);
  }
  if (place.frames < kLeastFound) {
    place.fault = fmt::format("mapped too little to be placed: it has {} keyframes", place.frames);
  } else if (place.found < kLeastFound) {
    place.fault = fmt::format("is not found in the map: {} of its {} keyframes are", place.found, place.frames);
  } else if (place.found < kLeastShare * on_map) {
    place.fault =
        fmt::format("is not found in the map: {} of its {} keyframes at places of the map are", place.found, on_map);
  } else if (place.elsewhere > std::max(1.0, kMaxElsewhere * place.found) || longest >= kRun) {
    place.fault = fmt::format("contradicts the map: {} of its {} keyframes found are more than 10 cm or 1 degree away",
                              place.elsewhere, place.found);
  }
  return place;
}

ImageCondition mean_condition(const SessionRecord& record) {
  ImageCondition mean;
  const auto count = static_cast<float>(record.poses.size());
  for (const PoseRecord& pose : record.poses) {
    mean.brightness += pose.image.brightness / count;
    mean.contrast += pose.image.contrast / count;
    mean.clipped += pose.image.clipped / count;
    mean.sharpness += pose.image.sharpness / count;
    mean.noise += pose.image.noise / count;
  }
  return mean;
}

MapGraph online_beside(const StoredSession& session, const MapGraph& offline) {
  using Position = std::array<double, 3>;
  const auto position_of = [](const MapGraph& map, PointId id) {
    const Eigen::Vector3d& position = map.find_point(id)->position_in_world;
    return Position{position.x(), position.y(), position.z()};
  };
  std::map<Position, PointId> originals;
  for (const PointId id : offline.point_ids()) originals.emplace(position_of(offline, id), id);
  MapGraph online = online_copy(session.stored.map);
  const std::vector<PointId> points = online.point_ids();
  for (std::size_t i = points.size() - session.record.copied_points; i < points.size(); ++i) {
    const auto original = originals.find(position_of(online, points[i]));
    if (original == originals.end()) continue;
    const std::vector<Observation> observers = online.observations(points[i]);
    for (const Observation& seen : observers) {
      Sighting sighting = online.find_keyframe(seen.keyframe)->sightings[static_cast<std::size_t>(seen.feature)];
      sighting.point = original->second;
      online.remove_observation(seen);
      online.add_observation(seen, sighting);
    }
  }
  return online;
}

}  // namespace byre
