#include "byre/slam/state.h"

namespace byre {

std::string_view to_string(State state) {
  switch (state) {
    case State::initialising:
      return "initialising";
    case State::tracking:
      return "tracking";
    case State::lost:
      return "lost";
  }
  return "unknown";
}

State next_state(State state, const Evidence& evidence) {
  if (!evidence.has_map) return State::initialising;
  if (evidence.pose_found) return State::tracking;
  return state == State::initialising ? State::initialising : State::lost;
}

}  // namespace byre
