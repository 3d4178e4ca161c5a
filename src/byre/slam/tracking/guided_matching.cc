#include "byre/slam/tracking/guided_matching.h"

#include "byre/features/descriptor.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

constexpr double kMinDepth = 0.05;  // metres

// A descriptor is valid slightly beyond the distances of its octaves, and up to 60 degrees from its mean direction.
constexpr float kDistanceSlack = 1.25f;
constexpr float kMinViewingCosine = 0.5f;

}  // namespace

std::optional<Projection> project_point(const MapPoint& point, const Pose& camera_from_world,
                                        const Eigen::Vector3d& camera_in_world, const Rig& rig) {
  const Eigen::Vector3d point_in_camera = camera_from_world * point.position_in_world;
  if (point_in_camera.z() < kMinDepth) return std::nullopt;
  const StereoPixel predicted = rig.project(point_in_camera);
  if (!rig.contains(predicted.head<2>())) return std::nullopt;
  const Eigen::Vector3f ray = (point.position_in_world - camera_in_world).cast<float>();
  const float distance = ray.norm();
  if (distance * kDistanceSlack < point.min_distance || distance > point.max_distance * kDistanceSlack) {
    return std::nullopt;
  }
  if (ray.dot(point.mean_viewing_direction) < kMinViewingCosine * distance) return std::nullopt;
  return Projection{predicted, expected_octave(point.max_distance, distance)};
}

int expected_octave(float max_distance, float distance) {
  static const float inverse_log = 1.0f / std::log(static_cast<float>(kOctaveScale));
  const int octave = static_cast<int>(std::lround(std::log(max_distance / distance) * inverse_log));
  return std::clamp(octave, 0, kOctaves - 1);
}

std::optional<FoundFeature> find_feature(const Features& features, const Descriptor& descriptor,
                                         const Projection& projection, const SearchOptions& options) {
  FoundFeature best, second;
  const float radius = options.radius * kScaleOfOctave[static_cast<std::size_t>(projection.octave)];
  const auto disparity = static_cast<float>(projection.predicted.z());
  const auto consider = [&](int feature) {
    const Keypoint& keypoint = features.keypoint(feature);
    if (keypoint.has_disparity() && std::abs(keypoint.disparity - disparity) > radius) return;
    const int distance = hamming_distance(descriptor, features.descriptor(feature));
    if (distance >= second.distance) return;
    const FoundFeature candidate{feature, distance, keypoint.octave};
    if (distance < best.distance) {
      second = best;
      best = candidate;
    } else {
      second = candidate;
    }
  };
  features.visit_area(projection.predicted.head<2>().cast<float>(), radius, projection.octave - 1,
                      projection.octave + 1, consider);
  if (best.distance > options.max_distance) return std::nullopt;
  const bool ambiguous = second.octave == best.octave &&
                         static_cast<float>(best.distance) > options.max_ratio * static_cast<float>(second.distance);
  return ambiguous ? std::nullopt : std::optional(best);
}

ScratchVector<ExpectedPoint> project_points(const MapView& map, std::span<const PointId> points,
                                            const Pose& camera_from_world, const Rig& rig) {
  const Eigen::Vector3d camera_in_world = inverse(camera_from_world).translation;
  ScratchVector<ExpectedPoint> expected;
  expected.reserve(points.size());
  for (const PointId id : points) {
    const MapPoint* const point = map.find_point(id);
    if (point == nullptr) continue;
    const auto projection = project_point(*point, camera_from_world, camera_in_world, rig);
    if (projection) expected.push_back({id, *projection});
  }
  return expected;
}

ScratchVector<PointMatch> match_expected(const Features& features, const MapView& map,
                                         std::span<const ExpectedPoint> expected, const SearchOptions& options) {
  struct Claim {
    PointId point;
    int distance = std::numeric_limits<int>::max();
  };
  ScratchVector<Claim> claims(static_cast<std::size_t>(features.size()));
  for (const ExpectedPoint& candidate : expected) {
    const MapPoint* const point = map.find_point(candidate.id);
    if (point == nullptr) continue;
    const auto found = find_feature(features, point->descriptor, candidate.projection, options);
    if (!found) continue;
    Claim& claim = claims[static_cast<std::size_t>(found->feature)];
    if (found->distance < claim.distance) claim = {candidate.id, found->distance};
  }
  ScratchVector<PointMatch> matches;
  matches.reserve(claims.size());
  for (int feature = 0; feature < features.size(); ++feature) {
    const Claim& claim = claims[static_cast<std::size_t>(feature)];
    if (claim.distance <= options.max_distance) matches.push_back({feature, claim.point, claim.distance});
  }
  return matches;
}

}  // namespace byre
