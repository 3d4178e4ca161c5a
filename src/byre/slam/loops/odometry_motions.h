#pragma once

#include "byre/body_motion.h"
#include "byre/slam/window/window.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

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
};

// Measured motions between successive keyframes of these, of one recording. Left out: a motion that contradicts the
// images, as with a spinning wheel; and a motion that a stereo camera observed, since it measures metres more precisely
// than wheels.
std::vector<KeyframeMotion> odometry_motions(const Map& online, std::vector<KeyframeId> keyframes, int recording,
                                             const OdometryQuery& odometry);

// The motions in the lengths of the map, if there are many: a common scale error of the wheels must not bend the map.
std::vector<KeyframeMotion> in_lengths_of(const Map& online, std::vector<KeyframeMotion> motions);

// Adds the motions between keyframes of the window.
void add_motions(MapWindow& window, const std::vector<KeyframeMotion>& motions);

}  // namespace byre
