#include "byre/slam/frame/still_image.h"

#include "byre/features/descriptor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace byre {
namespace {

constexpr int kMostSamples = 300;    // corners that are compared
constexpr int kFewestSamples = 30;   // corners that a decision needs
constexpr int kCoarsestOctave = 3;   // corners of coarser octaves are too inexact
constexpr float kStays = 1.5f;       // pixels of the octave, largest shift of a corner by noise
constexpr int kAlike = 64;           // bits, largest distance of descriptors of one corner under noise
constexpr double kStillShare = 0.4;  // minimum share of corners that stay at a standstill

bool stays_at(const Features& features, const Keypoint& keypoint, const Descriptor& descriptor) {
  int least = std::numeric_limits<int>::max();
  features.visit_area(
      keypoint.pixel, kStays * kScaleOfOctave[keypoint.octave], keypoint.octave, keypoint.octave,
      [&](int feature) { least = std::min(least, hamming_distance(descriptor, features.descriptor(feature))); });
  return least <= kAlike;
}

// Shift of a corner by the motion, pixels. then: its position in the camera before the motion.
Eigen::Vector2d shift_by(const Eigen::Vector2d& pixel, const Eigen::Vector3d& then, const Pose& now_from_then,
                         const Rig& rig) {
  constexpr double kNearest = 0.05;  // minimum depth, map units
  Eigen::Vector3d in_camera = now_from_then * then;
  in_camera.z() = std::max(kNearest, in_camera.z());
  return rig.project(in_camera).head<2>() - pixel;
}

// The smallest motion within three sigmas of the measured one, in length and in angle.
Pose least_motion(const BodyMotion& measured) {
  constexpr double kSigmas = 3.0;
  const auto share_left = [](double size, double variance) {
    return size > 0.0 ? std::max(0.0, 1.0 - kSigmas * std::sqrt(std::max(0.0, variance)) / size) : 0.0;
  };
  const Eigen::Vector3d& way = measured.last_from_body.translation;
  const Eigen::Vector3d turn = rotation_log(measured.last_from_body.rotation);
  const Matrix6& covariance = measured.covariance;
  return {rotation_exp(share_left(turn.norm(), rotation_variance(covariance)) * turn),
          share_left(way.norm(), position_variance(covariance)) * way};
}

// The motion of the camera, now_from_then.
Pose of_camera(const Pose& then_from_now_of_body, const Rig& rig) {
  return inverse(inverse(rig.body_from_camera) * then_from_now_of_body * rig.body_from_camera);
}

// Within the error that a trusted pose may have.
bool is_small(const Pose& motion) {
  constexpr double kMetres = 0.1;
  constexpr double kRadians = 0.05;
  return motion.translation.norm() < kMetres && rotation_log(motion.rotation).norm() < kRadians;
}

// Whether the measurement is more certain than a prediction by the velocity.
bool is_known_better(const BodyMotion& measured, const Vector6& velocity, double seconds) {
  constexpr double kShare = 0.3;
  constexpr double kLeast = 1e-3;  // metres and radians
  const double way_sigma = std::sqrt(std::max(0.0, position_variance(measured.covariance)));
  const double turn_sigma = std::sqrt(std::max(0.0, rotation_variance(measured.covariance)));
  return way_sigma <= kShare * velocity.head<3>().norm() * seconds + kLeast &&
         turn_sigma <= kShare * velocity.tail<3>().norm() * seconds + kLeast;
}

}  // namespace

// depth: depth of corners without a disparity, map units.
void StillImage::compare(const Features& features, const Rig& rig, double depth) {
  corners_.clear();
  for (const auto& [keypoint, descriptor] : reference_) {
    const Eigen::Vector2d pixel = keypoint.pixel.cast<double>();
    const bool has_depth = rig.is_stereo() && keypoint.has_disparity();
    const Eigen::Vector3d in_camera = has_depth ? rig.triangulate({pixel.x(), pixel.y(), keypoint.disparity})
                                                : Eigen::Vector3d(depth * rig.ray(pixel));
    corners_.push_back({pixel, in_camera, stays_at(features, keypoint, descriptor)});
  }
}

// Whether enough of the corners that the motion would have moved stay.
bool StillImage::is_contradicted_by(const Pose& now_from_then, const Rig& rig) const {
  constexpr double kLeastShift = 4.0;           // pixels
  constexpr double kLeastShiftOfWidth = 0.008;  // share of the image width
  constexpr double kLeastMoved = 0.15;          // minimum share of corners that should have moved
  constexpr double kStaying = 0.4;              // minimum share of these that stay
  const double least = std::max(kLeastShift, kLeastShiftOfWidth * rig.width);
  int moved = 0, staying = 0;
  for (const Corner& corner : corners_) {
    if (!(shift_by(corner.pixel, corner.in_camera, now_from_then, rig).norm() >= least)) continue;
    ++moved;
    if (corner.stays) ++staying;
  }
  return moved >= kFewestSamples && moved >= kLeastMoved * static_cast<double>(corners_.size()) &&
         staying >= kStaying * moved;
}

// Whether the camera moved steadily up to the reference and then stopped faster than a robot can. later: velocity at
// the reference.
bool StillImage::is_sudden_stop(const Vector6& later, double seconds, const Rig& rig) const {
  constexpr double kDeceleration = 3.0;  // map units (metres) and radians per second squared
  constexpr double kSteady = 0.4;        // largest change as a share of the image motion
  if ((later.head<3>().norm() + later.tail<3>().norm()) < kDeceleration * seconds) return false;
  double motion = 0.0, change = 0.0;
  for (const Corner& corner : corners_) {
    const auto shift = [&](const Vector6& velocity) {
      return shift_by(corner.pixel, corner.in_camera, exp_pose(velocity * seconds), rig);
    };
    motion += shift(later).norm();
    change += (shift(later) - shift(velocity_)).norm();
  }
  return change <= kSteady * motion;
}

void StillImage::restart(const Frame& frame, const Vector6& velocity) {
  const Features& features = *frame.features;
  const int step = std::max(1, features.size() / kMostSamples);
  reference_.clear();
  for (int i = 0; i < features.size(); i += step) {
    const Keypoint& keypoint = features.keypoint(i);
    if (keypoint.octave <= kCoarsestOctave) reference_.push_back({keypoint, features.descriptor(i)});
  }
  since_ = frame.time;
  velocity_ = velocity;
  stopped_from_.reset();
  measured_ = no_motion();
  is_contradicted_ = false;
}

Stillness StillImage::note(const Frame& frame, const Rig& rig, const std::optional<BodyMotion>& measured,
                           const CameraMotion& before) {
  constexpr double kLongest = 0.3;  // seconds for which the velocity predicts motion
  if (reference_.empty()) {
    restart(frame, before.velocity);
    return {};
  }
  compare(*frame.features, rig, before.depth);
  const auto staying = static_cast<double>(std::ranges::count_if(corners_, &Corner::stays));
  if (corners_.size() < kFewestSamples || staying < kStillShare * static_cast<double>(corners_.size())) {
    restart(frame, before.velocity);
    return {};
  }
  const double seconds = to_seconds(frame.time - since_);
  const bool is_first = !stopped_from_;
  if (is_first) {
    stopped_from_ = is_sudden_stop(before.velocity, seconds, rig) ? before.velocity : Vector6(Vector6::Zero());
  }
  measured_ = measured_ && measured ? std::optional(*measured_ * *measured) : std::nullopt;
  if (measured_ && is_contradicted_by(of_camera(least_motion(*measured_), rig), rig)) {
    is_contradicted_ = true;
  } else if (measured_ && is_contradicted_ && is_small(measured_->last_from_body)) {
    is_contradicted_ = false;
  }
  const double goes_on = std::min(seconds, kLongest);
  if (!(measured_ && is_known_better(*measured_, *stopped_from_, goes_on)) &&
      is_contradicted_by(exp_pose(*stopped_from_ * goes_on), rig)) {
    is_contradicted_ = true;
  }
  return {true, is_contradicted_, seconds};
}

}  // namespace byre
