#include "byre/session/global_lane.h"

#include <cassert>
#include <utility>

namespace byre {

void GlobalLane::close_loops(const Map& map, const std::vector<LoopEdge>& loops) {
  assert(idle());
  snapshot_ = std::make_shared<const MapWindow>(whole_map(map));
  executor_->submit([snapshot = snapshot_, is_hurried = is_hurried_, loops, options = options_] {
    return adjust_map(*snapshot, loops, options, [&is_hurried] { return is_hurried->load(); });
  });
}

void GlobalLane::collect() {
  if (auto finished = executor_->collect()) correction_ = std::move(finished->delta);
}

void GlobalLane::finish() {
  if (auto finished = executor_->finish()) correction_ = std::move(finished->delta);
}

AppliedCorrection GlobalLane::apply(Map& online) {
  assert(is_waiting());
  const MapDelta correction = *std::exchange(correction_, std::nullopt);
  LengthChanges changes = apply_correction(correction, *snapshot_, online);
  snapshot_.reset();
  return {correction, std::move(changes)};
}

}  // namespace byre
