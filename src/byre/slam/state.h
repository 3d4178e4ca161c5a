#pragma once

#include <cstdint>
#include <string_view>

namespace byre {

// initialising -> tracking <-> lost. Lost frames have no pose.
enum class State : std::uint8_t { initialising, tracking, lost };

std::string_view to_string(State state);

// What one frame told us.
struct Evidence {
  bool has_map = false;  // a first map exists
  bool pose_found = false;
};

State next_state(State state, const Evidence& evidence);

}  // namespace byre
