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

MapDelta GlobalLane::apply(Map& online) {
  assert(is_waiting());
  apply_correction(*correction_, *snapshot_, online);
  snapshot_.reset();
  return *std::exchange(correction_, std::nullopt);
}

}  // namespace byre
