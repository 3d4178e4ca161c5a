#pragma once

#include "byre/map/map.h"
#include "byre/slam/delta.h"

#include <vector>

namespace byre {

struct RegistrationOptions {
  int confirmations = 3;         // frames that must agree before a place is used for mapping
  double accept_log_odds = 2.5;  // log-odds from which a place found is trusted, nats; see PlaceHypothesis
  double max_speed = 3.0;        // metres per second, highest speed of the robot
  int max_misses = 2;            // contradicting finds before a registration is given up
};

inline constexpr int kConfirmationsOfJump = 10;  // frames, where the robot was carried or went faster than it can

// A path of online keyframes, in the order of ids, moved so that its newest end lies in the offline map. What comes
// before:
//   rigid   goes along as a whole: it had no place in the offline map before
//   spread  bends by its share of the path: at the first keyframe both maps agreed
enum class CorrectionShape : std::uint8_t { rigid, spread };

MapDelta correction_of(const Map& online, const std::vector<KeyframeId>& path, const Pose& offline_from_online,
                       CorrectionShape shape);

}  // namespace byre
