#pragma once

#include <cstdint>
#include <string_view>

namespace byre {

// Why two views do not tell how the camera moved; ordered by how far the attempt came.
enum class TwoViewFailure : std::uint8_t {
  none,
  too_few_matches,   // too few corners of one view were found in the other
  no_common_motion,  // too few matches agree on any motion
  rotation_only,     // a turn on the spot explains the matches as well
  small_parallax,    // the camera has hardly moved
  planar_ambiguity,  // two motions explain the matches alike, as a plane allows
  too_few_points,    // too few matches tell a depth
  uncertain          // the matches leave the direction of the motion open by more than is useful
};

std::string_view to_string(TwoViewFailure failure);

}  // namespace byre
