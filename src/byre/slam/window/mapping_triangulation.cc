#include "byre/features/descriptor.h"
#include "byre/geometry/triangulation.h"
#include "byre/optimise/robust_error.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/window/mapping_steps.h"

#include <cmath>

namespace byre {
namespace {

constexpr int kMaxDistance = 50;   // bits
constexpr float kMaxRatio = 0.8f;  // best over second-best distance along the epipolar line
constexpr float kEpipolarSigmas = 2.5f;
constexpr double kMinAngle = 0.005;  // radians between the rays; beyond that the covariance decides

struct FreeFeature {
  int index = 0;
  int octave = 0;
  float max_pixels_off = 0.0f;  // largest distance from the epipolar line, pixels
  Eigen::Vector3d ray;          // z = 1
};

std::vector<FreeFeature> free_features(const MapWindow& window, int keyframe) {
  const WindowKeyframe& entry = window.keyframe(keyframe);
  const Rig& rig = window.rig_of(entry);
  std::vector<FreeFeature> free;
  for (int i = 0; i < entry.keyframe.frame.features->size(); ++i) {
    if (entry.point_of_feature[static_cast<std::size_t>(i)] != kNoPoint) continue;
    const Keypoint& keypoint = entry.keyframe.frame.features->keypoint(i);
    free.push_back({i, keypoint.octave, kEpipolarSigmas * corner_measurement(keypoint).sigma,
                    rig.ray(keypoint.pixel.cast<double>())});
  }
  return free;
}

// The other view's feature that is on the epipolar line and looks similar.
std::optional<int> match_along_epipolar_line(const CameraView& first, const FreeFeature& feature,
                                             const CameraView& second, const std::vector<FreeFeature>& candidates,
                                             const Eigen::Matrix3d& essential) {
  const Eigen::Vector3d line = essential * feature.ray;
  const double inverse_norm = second.rig.focal / line.head<2>().norm();
  const Descriptor& descriptor = first.features.descriptor(feature.index);
  int best = -1, best_distance = kMaxDistance + 1, second_distance = kMaxDistance + 1;
  for (const FreeFeature& candidate : candidates) {
    if (std::abs(candidate.octave - feature.octave) > 2) continue;
    const double pixels_off = std::abs(line.dot(candidate.ray)) * inverse_norm;
    if (pixels_off > candidate.max_pixels_off) continue;
    const int distance = hamming_distance(descriptor, second.features.descriptor(candidate.index));
    if (distance < best_distance) {
      second_distance = best_distance;
      best_distance = distance;
      best = candidate.index;
    } else if (distance < second_distance) {
      second_distance = distance;
    }
  }
  if (best < 0 || static_cast<float>(best_distance) > kMaxRatio * static_cast<float>(second_distance)) {
    return std::nullopt;
  }
  return best;
}

std::optional<Eigen::Vector3d> triangulate_pixels(const CameraView& first, const Eigen::Vector2f& first_pixel,
                                                  const CameraView& second, const Eigen::Vector2f& second_pixel) {
  const Pose second_from_first = second.camera_from_world * inverse(first.camera_from_world);
  const auto point_in_first = triangulate(first.rig.ray(first_pixel.cast<double>()),
                                          second.rig.ray(second_pixel.cast<double>()), second_from_first, kMinAngle);
  if (!point_in_first) return std::nullopt;
  return inverse(first.camera_from_world) * *point_in_first;
}

// Information (inverse covariance) of a pixel about a point in world.
Eigen::Matrix3d pixel_information(const CameraView& view, const Eigen::Vector3d& point_in_world, double sigma) {
  const Eigen::Vector3d point_in_camera = view.camera_from_world * point_in_world;
  const Eigen::Matrix<double, 2, 3> jacobian =
      view.rig.projection_jacobian(point_in_camera).topRows<2>() * view.camera_from_world.rotation.toRotationMatrix();
  return jacobian.transpose() * jacobian / (sigma * sigma);
}

bool agrees(const CameraView& view, const Eigen::Vector3d& point_in_world, const Eigen::Vector2f& pixel, double sigma,
            double max_squared_error) {
  const Eigen::Vector3d point_in_camera = view.camera_from_world * point_in_world;
  if (point_in_camera.z() <= 0.0) return false;
  const Eigen::Vector2d error = view.rig.project(point_in_camera).head<2>() - pixel.cast<double>();
  return error.squaredNorm() <= max_squared_error * sigma * sigma;
}

struct TriangulatedPoint {
  Eigen::Vector3d position_in_world;
  Eigen::Matrix3d covariance;
  PixelMeasurement second;
};

std::optional<TriangulatedPoint> triangulate_match(const CameraView& first, int first_feature, const CameraView& second,
                                                   int second_feature, const MappingOptions& options) {
  const Keypoint& first_keypoint = first.features.keypoint(first_feature);
  const Keypoint& second_keypoint = second.features.keypoint(second_feature);
  const auto rough = triangulate_pixels(first, first_keypoint.pixel, second, second_keypoint.pixel);
  if (!rough) return std::nullopt;
  const PixelMeasurement measured =
      measure_pixel({first, first_feature, first_keypoint.pixel}, *rough, second, second_feature);
  const auto point = triangulate_pixels(first, first_keypoint.pixel, second, measured.pixel);
  if (!point) return std::nullopt;
  const double first_sigma = reference_sigma(first.features, first_feature);
  const double allowed_sigma = std::hypot(static_cast<double>(measured.sigma), options.pose_sigma);
  if (!agrees(first, *point, first_keypoint.pixel, allowed_sigma, kMaxSquaredErrorMono) ||
      !agrees(second, *point, measured.pixel, allowed_sigma, kMaxSquaredErrorMono)) {
    return std::nullopt;
  }
  const Eigen::Matrix3d covariance =
      (pixel_information(first, *point, first_sigma) + pixel_information(second, *point, measured.sigma)).inverse();
  const double depth = (first.camera_from_world * *point).z();
  if (!(covariance.trace() < std::pow(options.max_relative_depth_sigma * depth, 2))) return std::nullopt;
  return TriangulatedPoint{*point, covariance, measured};
}

void triangulate_pair(MapWindow& window, int first, int second, const MappingOptions& options) {
  const CameraView first_view = view_of(window, first);
  const CameraView second_view = view_of(window, second);
  const Pose second_from_first = second_view.camera_from_world * inverse(first_view.camera_from_world);
  const Eigen::Matrix3d essential = skew(second_from_first.translation) * second_from_first.rotation.toRotationMatrix();
  const std::vector<FreeFeature> candidates = free_features(window, second);
  for (const FreeFeature& feature : free_features(window, first)) {
    const auto match = match_along_epipolar_line(first_view, feature, second_view, candidates, essential);
    if (!match || window.keyframe(second).point_of_feature[static_cast<std::size_t>(*match)] != kNoPoint) {
      continue;
    }
    const auto point = triangulate_match(first_view, feature.index, second_view, *match, options);
    if (!point) continue;
    const Observation reference{window.keyframe(first).id, feature.index};
    const Keypoint& keypoint = first_view.features.keypoint(feature.index);
    window.points.push_back({std::nullopt,
                             make_point(point->position_in_world, point->covariance, reference, first_view.features,
                                        first_view.camera_from_world),
                             {},
                             0,
                             false});
    const int index = static_cast<int>(window.points.size()) - 1;
    add_observation(window, index, {first, feature.index},
                    {std::nullopt, keypoint.pixel, reference_sigma(first_view.features, feature.index)});
    add_observation(window, index, {second, *match}, {std::nullopt, point->second.pixel, point->second.sigma});
  }
}

}  // namespace

void triangulate_new_points(MapWindow& window, int keyframe, const MappingOptions& options) {
  for (const int other : nearest_neighbours(window, keyframe, options.triangulation_neighbours, kOfflineNeighbours)) {
    triangulate_pair(window, keyframe, other, options);
  }
}

}  // namespace byre
