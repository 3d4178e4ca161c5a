#pragma once

#include <cstdint>
#include <string_view>

namespace byre {

// State of tracking. initialising -> tracking <-> relocalising -> lost; a confirmed pose leads back to tracking.
//   initialising  no pose yet: no map, or not found in the offline map
//   tracking      confirmed pose
//   relocalising  pose lost, or found and not confirmed yet
//   lost          no confirmed pose for 10 s (option mission.lost_after_s); relocalisation continues
enum class State : std::uint8_t { initialising, tracking, relocalising, lost };

std::string_view to_string(State state);

}  // namespace byre
