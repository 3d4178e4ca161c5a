#include "byre/mapping/global_lane.h"

#include "byre/slam/recent_map.h"
#include "byre/slam/stowed_features.h"

#include <cassert>
#include <utility>

namespace byre {

MapToBend copy_to_bend(const Map& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops,
                       const std::vector<KeyframeMotion>& motions) {
  auto recent = std::make_shared<MapWindow>(recent_map(map, first_new, loops));
  add_motions(*recent, motions);
  auto outline = std::make_shared<const MapWindow>(outline_of(*recent));
  return {std::move(recent), std::move(outline), loops};
}

void GlobalLane::close_loops(MapToBend map) {
  assert(idle());
  outline_ = map.outline;
  worker_.start([map = std::move(map), is_hurried = is_hurried_, options = options_, stowed = stowed_] {
    return adjust_map(std::move(*map.recent), *map.outline, map.loops, options,
                      forgetting_looks(*stowed, [&] { return is_hurried->load(); }));
  });
}

void GlobalLane::calibrate(std::shared_ptr<const MapWindow> whole, const CalibrationState& state, int rig,
                           const SelfCalibrationOptions& options) {
  assert(idle());
  worker_.start([whole = std::move(whole), state, rig, options, is_hurried = is_hurried_, stowed = stowed_] {
    const auto should_stop = forgetting_looks(*stowed, [&] { return is_hurried->load(); });
    const auto refined = self_calibrate(*whole, state, rig, options, should_stop);
    if (!refined) return Refinement();
    Refinement result = recalibration_by(*refined, state, *whole, rig);
    stowed->forget_looks();
    return result;
  });
}

std::optional<Recalibration> GlobalLane::take_calibration() {
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
