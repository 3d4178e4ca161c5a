#include "byre/map/map_values.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace byre {
namespace {

template <typename Number>
bool are_finite(std::initializer_list<Number> numbers) {
  return std::ranges::all_of(numbers, [](Number number) { return std::isfinite(number); });
}

template <typename Number>
bool is_positive(Number number) {
  return std::isfinite(number) && number > 0;
}

bool is_image_size(int width, int height) {
  return width >= 1 && height >= 1 && width <= kMaxImageSize && height <= kMaxImageSize;
}

// Pixel centres have integer coordinates, so an image begins at -0.5.
bool is_in_image(const Eigen::Vector2f& pixel, const Rig& rig) {
  return pixel.x() >= -0.5f && pixel.y() >= -0.5f && pixel.x() <= static_cast<float>(rig.width) - 0.5f &&
         pixel.y() <= static_cast<float>(rig.height) - 0.5f;
}

std::string_view fault_in(const StereoPartner& right) {
  const std::string_view fault = fault_in(right.camera);
  return fault.empty() ? fault_in(right.right_from_left) : fault;
}

}  // namespace

bool is_unit(const Eigen::Vector3f& direction) {
  constexpr float kTolerance = 1e-3f;
  return std::abs(direction.norm() - 1.0f) < kTolerance;
}

std::string_view fault_in(const Pose& pose) {
  constexpr double kTolerance = 1e-6;
  const bool is_rotation = std::abs(pose.rotation.norm() - 1.0) < kTolerance;
  return is_rotation && pose.translation.allFinite() ? "" : "has an invalid pose";
}

std::string_view fault_in(const Camera& camera) {
  if (!is_image_size(camera.width, camera.height)) return "has an invalid image size";
  const bool is_sound = is_positive(camera.fx) && is_positive(camera.fy) && are_finite({camera.cx, camera.cy}) &&
                        std::ranges::all_of(camera.distortion, [](double value) { return std::isfinite(value); });
  return is_sound ? "" : "has an invalid camera";
}

std::string_view fault_in(const Calibration& calibration) {
  if (const auto fault = fault_in(calibration.left); !fault.empty()) return fault;
  if (const auto fault = fault_in(calibration.body_from_left); !fault.empty()) return fault;
  constexpr double kLongestReadout = 1.0;  // seconds; the comparison is false for NaN
  if (!(std::abs(calibration.readout_time) <= kLongestReadout)) return "has an invalid readout time";
  return calibration.right ? fault_in(*calibration.right) : "";
}

std::string_view fault_in(const RefinedCalibration& refined) {
  if (const auto fault = fault_in(refined.calibration); !fault.empty()) return fault;
  const bool is_sound = refined.change.allFinite() && (refined.sigma_before.array() >= 0.0).all() &&
                        (refined.sigma_after.array() >= 0.0).all() && refined.sigma_before.allFinite() &&
                        refined.sigma_after.allFinite() && refined.keyframes >= 0 && refined.observations >= 0 &&
                        std::isfinite(refined.shift) && refined.shift >= 0.0;
  return is_sound ? "" : "has an invalid refined calibration";
}

std::string_view fault_in(const SourceRecording& recording) {
  if (const auto fault = fault_in(recording.calibration); !fault.empty()) return fault;
  if (recording.refined) {
    if (const auto fault = fault_in(*recording.refined); !fault.empty()) return fault;
    if (recording.refined->calibration.right.has_value() != recording.calibration.right.has_value()) {
      return "has a refined calibration of other cameras";
    }
  }
  return recording.first_time <= recording.last_time ? "" : "ends before it begins";
}

std::string_view fault_in(const Rig& rig) {
  if (!is_image_size(rig.width, rig.height)) return "has an invalid image size";
  const bool is_sound = is_positive(rig.focal) && are_finite({rig.cx, rig.cy, rig.baseline}) && rig.baseline >= 0.0;
  return is_sound ? fault_in(rig.body_from_camera) : "has an invalid camera";
}

std::string_view fault_in(const Keypoint& keypoint, const Rig& rig) {
  if (!is_in_image(keypoint.pixel, rig)) return "has a keypoint outside its image";
  if (keypoint.octave >= kOctaves) return "has a keypoint in an octave that does not exist";
  const bool is_finite = are_finite({keypoint.disparity, keypoint.disparity_sigma, keypoint.angle, keypoint.response});
  const bool is_sound = is_finite && (!keypoint.has_disparity() || keypoint.disparity_sigma > 0.0f);
  return is_sound ? "" : "has a keypoint with invalid values";
}

std::string_view fault_in(const Patch& patch) {
  const bool is_inside = (patch.centre.array() >= 0.0f).all() && (patch.centre.array() <= Patch::kSize - 1.0f).all();
  return is_inside ? "" : "has a patch without its centre";
}

std::string_view fault_in(const Sighting& sighting) {
  return sighting.pixel.allFinite() && is_positive(sighting.pixel_sigma) ? "" : "has a sighting with invalid values";
}

std::string_view fault_in(const MapPoint& point) {
  if (!point.position_in_world.allFinite()) return "has a position that is not finite";
  if (!point.covariance.allFinite()) return "has a covariance that is not finite";
  if (!is_unit(point.mean_viewing_direction)) return "has a viewing direction that is not of unit length";
  const bool is_range = point.min_distance >= 0.0f && point.min_distance <= point.max_distance;
  return is_range && std::isfinite(point.max_distance) ? "" : "has an invalid distance range";
}

std::string_view fault_in(const PlanRegistration& registration) {
  if (!is_positive(registration.plan_from_map.scale)) return "has a scale that is not positive";
  if (!registration.covariance.allFinite()) return "has a covariance that is not finite";
  if ((registration.covariance.diagonal().array() < 0.0).any()) return "has a negative variance";
  return fault_in(registration.plan_from_map.target_from_source);
}

}  // namespace byre
