#pragma once

#include <cstdint>
#include <string_view>

namespace byre {

// Reason why two views do not determine a motion, in the order of the steps of the estimator.
enum class TwoViewFailure : std::uint8_t {
  none,
  too_few_matches,   // too few matches between the views
  no_common_motion,  // too few matches agree on a motion
  rotation_only,     // a pure rotation explains the matches as well
  small_parallax,    // baseline too short
  planar_ambiguity,  // two motions explain the matches equally well, as for a planar scene
  too_few_points,    // too few matches with a depth
  uncertain          // direction of motion too uncertain
};

std::string_view to_string(TwoViewFailure failure);

}  // namespace byre
