#pragma once

#include "byre/body_motion.h"
#include "byre/slam/window/window.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

// Scale of visual motion relative to measured motion: least squares, weighted by the covariance of the measured motion.
class LengthRatio {
 public:
  void add(const BodyMotion& measured, const Pose& seen);
  int count() const { return count_; }  // number of motions
  // Empty if visual and measured motions have opposite directions.
  std::optional<double> value() const;

 private:
  int count_ = 0;
  double measured_squared_ = 0.0;
  double visual_by_measured_ = 0.0;
};

BodyMotion scale_motion(const BodyMotion& motion, double scale);

// Motion of the body between two times in the map's lengths, measured by wheels and a gyroscope; empty: unknown.
using OdometryQuery = std::function<std::optional<BodyMotion>(Timestamp earlier, Timestamp later)>;

// Largest distance of the body from its earlier position, in the map's lengths, by the rotation of its wheels; empty:
// unknown.
using ReachQuery = std::function<std::optional<double>(Timestamp earlier, Timestamp later)>;

// Measured motion between successive keyframes of the online map.
struct KeyframeMotion {
  KeyframeId earlier;
  KeyframeId later;
  BodyMotion motion;
  bool lacks_visual_constraint = false;  // both share hardly any points, so only the measurement relates them
  bool holds_scale = false;              // see WindowMotion
};

// Measured motions between successive keyframes of these, of one recording. Left out: a motion that contradicts the
// images, as with a spinning wheel; and a motion that a stereo camera observed, since it measures metres more precisely
// than wheels.
std::vector<KeyframeMotion> odometry_motions(const MapGraph& online, std::vector<KeyframeId> keyframes, int recording,
                                             const OdometryQuery& odometry);

// The motions in the lengths of the map, if there are many: a common scale error of the wheels must not bend the map.
std::vector<KeyframeMotion> in_lengths_of(const MapGraph& online, std::vector<KeyframeMotion> motions);

// Adds the motions between keyframes of the window.
void add_motions(MapWindow& window, const std::vector<KeyframeMotion>& motions);

}  // namespace byre
