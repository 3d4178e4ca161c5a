#pragma once

#include "byre/map/map_graph.h"
#include "byre/slam/window/delta.h"

#include <vector>

namespace byre {

struct RegistrationOptions {
  int confirmations = 3;          // frames that must agree before mapping uses a place
  double accept_log_odds = 3.25;  // log-odds from which a place is accepted, nats; see PlaceHypothesis
  double max_speed = 3.0;         // metres per second, highest speed of the robot
  int max_misses = 2;             // contradicting finds before a registration is given up
};

inline constexpr int kConfirmationsOfJump = 10;  // frames, after the robot was carried or exceeded max_speed

// Correction of a path of online keyframes, in order of ids, that aligns its newest end with the offline map. Earlier
// keyframes:
//   rigid   move as a whole, without their observations of offline points: the path was not registered, or wrongly
//   spread  move by their share of the path: both maps agreed at the first keyframe
enum class CorrectionShape : std::uint8_t { rigid, spread };

MapDelta correction_of(const MapGraph& online, const std::vector<KeyframeId>& path, const Pose& offline_from_online,
                       CorrectionShape shape);

}  // namespace byre
