#include "byre/mapping/global_lane.h"

#include "byre/slam/recent_map.h"
#include "byre/slam/stowed_features.h"

#include <cassert>
#include <utility>

namespace byre {

void GlobalLane::close_loops(const Map& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops,
                             const std::vector<KeyframeMotion>& motions) {
  assert(idle());
  const auto recent = std::make_shared<MapWindow>(recent_map(map, first_new, loops));
  add_motions(*recent, motions);
  outline_ = std::make_shared<const MapWindow>(outline_of(*recent));
  worker_.start([recent, outline = outline_, is_hurried = is_hurried_, loops, options = options_, stowed = stowed_] {
    return adjust_map(std::move(*recent), *outline, loops, options,
                      forgetting_looks(*stowed, [&] { return is_hurried->load(); }));
  });
}

void GlobalLane::calibrate(const MapView& map, const CalibrationState& state, int rig,
                           const SelfCalibrationOptions& options) {
  assert(idle());
  const auto snapshot = std::make_shared<const MapWindow>(whole_map(map));
  worker_.start([snapshot, state, rig, options, is_hurried = is_hurried_, stowed = stowed_] {
    return self_calibrate(*snapshot, state, rig, options,
                          forgetting_looks(*stowed, [&] { return is_hurried->load(); }));
  });
}

std::optional<RefinedCalibration> GlobalLane::take_calibration() {
  if (!outcome_ || !std::holds_alternative<Refinement>(*outcome_)) return std::nullopt;
  return std::get<Refinement>(*std::exchange(outcome_, std::nullopt));
}

void GlobalLane::collect() {
  keep(worker_.collect());
}

void GlobalLane::finish() {
  keep(worker_.finish());
}

void GlobalLane::keep(std::optional<Worker<Outcome>::Finished> finished) {
  if (finished) outcome_ = std::move(finished->result);
}

AppliedCorrection GlobalLane::apply(Map& online) {
  assert(is_waiting());
  MapDelta correction = std::get<MapDelta>(*std::exchange(outcome_, std::nullopt));
  LengthChanges changes = apply_correction(correction, *outline_, online);
  outline_.reset();
  return {std::move(correction), std::move(changes)};
}

}  // namespace byre
