#pragma once

#include <cstdint>
#include <string_view>

namespace byre {

// initialising -> tracking <-> relocalising -> lost. From relocalising and lost a confirmed pose leads back to
// tracking.
//   initialising  no pose yet: no first map, or not found in the offline one
//   tracking      a pose that is believed
//   relocalising  the pose was lost, or one was found that is not confirmed yet
//   lost          relocalising has failed for StateOptions::lost_after; it goes on
enum class State : std::uint8_t { initialising, tracking, relocalising, lost };

std::string_view to_string(State state);

}  // namespace byre
