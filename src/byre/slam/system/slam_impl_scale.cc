// Part of slam_impl.h: the map's unit by tags and wheels, and the focal length that turns by wheels suggest.

#include "byre/slam/system/slam_impl.h"

#include "byre/map/mapped_tag.h"
#include "byre/slam/tracking/body_pose.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace byre {

// Wheels measured the motion between the first two keyframes of one camera, if that gave the map its unit.
void SlamImpl::begin_wheels() {
  const std::vector<KeyframeId> ids = online().keyframe_ids();
  if (!session_->is_scaled_by_odometry() || ids.size() < 2) return prior_.forget_scale();
  const Keyframe &first = *online().find_keyframe(ids[0]), &second = *online().find_keyframe(ids[1]);
  prior_.begin_metric({first.frame.time, second.frame.time,
                       inverse(body_pose(rig_of(online(), first), first.camera_from_world)) *
                           body_pose(rig_of(online(), second), second.camera_from_world)});
}

double SlamImpl::focal_change() const {
  const auto refined = session_->self_calibration();
  return refined ? refined->calibration.left.fx / given_.left.fx : 1.0;
}

// Turns in images are inversely proportional to the focal length. A pair of cameras or a depth camera would show a
// wrong one in its map.
void SlamImpl::warn_of_focal_length() {
  constexpr double kWheelSigma = 0.02;  // natural logarithm, of turns by wheels
  constexpr double kSigmas = 3.0;
  const auto turns = prior_.turn_ratio();
  if (!turns) return;
  const double sigma = std::hypot(kWheelSigma, turns->sigma), ratio = turns->value / focal_change();
  if (std::abs(std::log(ratio)) < kSigmas * sigma) return;
  const double focal = given_.left.fx;
  prior_.warn(
      {MotionSensor::wheels,
       {},
       fmt::format("the camera turns {:.3g} times as far in images as by wheels: its focal length is likely "
                   "{:.0f} px (sigma {:.0f} px) instead of {:.0f} px, or the wheels' track width is wrong",
                   ratio, focal * turns->value, focal * sigma, focal * focal_change()),
       fmt::format("calibrate the camera, or set the focal lengths fx and fy in the calibration file to {:.0f}, "
                   "and map again",
                   focal * turns->value)});
}

// Keeps the map's own unit if tags do not determine the scale, or if wheels contradict it.
void SlamImpl::scale_by_tags() {
  constexpr double kMaxWheelSigma = 0.05;
  constexpr double kMaxDifference = 0.1;  // natural logarithm
  const std::map<TagId, UnitEstimate> units = units_by_tags(online(), inputs_.tags);
  const auto unit = common_unit(units);
  const auto refuse = [this](const std::string& fault, const std::string& remedy) {
    prior_.warn({MotionSensor::tags, {}, fault + "; they do not scale the map", remedy});
  };
  if (!unit) {
    if (units.empty()) return;
    std::vector<std::string> lengths;
    for (const auto& [id, each] : units) {
      lengths.push_back(fmt::format("{:.3g} m by {}", 1.0 / each.lengths_per_metre, to_string(id)));
    }
    return refuse(
        fmt::format("the unit of the map is {}, and two tags or more have to agree", fmt::join(lengths, ", ")),
        "check the sizes of the tags, and hang two or more in view of the way");
  }
  const double factor = 1.0 / unit->lengths_per_metre;
  const auto& wheels = prior_.wheels();
  if (wheels && wheels->scale_sigma() <= kMaxWheelSigma) {
    const double ratio = factor / wheels->metres_per_unit;
    if (std::abs(std::log(ratio)) > kMaxDifference) {
      return refuse(fmt::format("AprilTags measure lengths {:.3g} times as large as wheels do", ratio),
                    "measure the tags and the wheel radius again");
    }
  }
  session_->rescale(factor);
  prior_.rescale(factor);
  scale_sigma_ = unit->sigma;
  is_scaled_by_tags_ = true;
  is_metric_ = true;
}

// Keeps the map's own unit if motions do not determine the scale.
double SlamImpl::scale_by_wheels() {
  // Share. A lever arm that is estimated together with the scale has errors beyond its sigma.
  const double max_sigma = prior_.uses_given_extrinsics() ? 0.08 : session_->is_scaled_by_odometry() ? 0.05 : 0.02;
  constexpr double kMaxTurnError = 0.05;  // share of the turns
  const auto& wheels = prior_.wheels();
  if (!wheels || wheels->scale_sigma() > max_sigma) return 1.0;
  // A wrong wheel radius scales path lengths and turns by the same factor. Turns of a distorted map differ by various
  // factors.
  if (std::abs(std::log(wheels->turn_errors.scale)) > kMaxTurnError || wheels->rotation_error > kMaxTurnError) {
    prior_.warn(
        {MotionSensor::wheels,
         {},
         fmt::format("wheels measure turns {:.3g} times as large as the camera does, with differences of {:.3g} "
                     "%; the map has no metric scale",
                     1.0 / wheels->turn_errors.scale, 100.0 * wheels->rotation_error),
         "calibrate the camera, wheel radius and track width, or scale the map with byre scale"});
    return 1.0;
  }
  const auto& extrinsics = inputs_.extrinsics;
  const double factor = wheels->metres_per_unit * (extrinsics ? extrinsics->wheel_scale : 1.0);
  session_->rescale(factor);
  scale_sigma_ =
      std::hypot(wheels->scale_sigma(), extrinsics ? extrinsics->wheel_scale_sigma : options_.wheel_scale_sigma);
  prior_.rescale(factor);
  is_metric_ = true;
  return factor;
}

Trajectory SlamImpl::refine_by_located(Trajectory all, const std::vector<Timestamp>& located) {
  prior_.note_located(located);
  prior_.reestimate(all, false);
  if (scale_sigma_ && !is_scaled_by_tags_) {
    scale_sigma_.reset();
    is_metric_ = false;
  }
  const double factor = is_metric_ ? 1.0 : scale_by_wheels();
  for (StampedPose& pose : all) pose.world_from_body = scale_lengths(pose.world_from_body, factor);
  return all;
}

}  // namespace byre
