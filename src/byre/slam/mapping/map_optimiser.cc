#include "byre/slam/mapping/map_optimiser.h"

#include "byre/slam/loops/recent_map.h"
#include "byre/slam/window/paged_features.h"

#include <cassert>

namespace byre {

LoopClosureInput copy_for_loop_closure(const Map& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops,
                                       const std::vector<KeyframeMotion>& motions) {
  auto recent = std::make_shared<MapWindow>(recent_map(map, first_new, loops));
  add_motions(*recent, motions);
  auto outline = std::make_shared<const MapWindow>(outline_of(*recent));
  return {std::move(recent), std::move(outline), loops};
}

void MapOptimiser::close_loops(LoopClosureInput map) {
  assert(idle());
  outline_ = map.outline;
  worker_.start(
      [map = std::move(map), is_finishing_early = is_finishing_early_, options = options_, page_file = page_file_] {
        return adjust_map(std::move(*map.recent), *map.outline, map.loops, options,
                          releasing_pages(*page_file, [&] { return is_finishing_early->load(); }));
      });
}

void MapOptimiser::calibrate(std::shared_ptr<const MapWindow> whole, const CalibrationState& state, int rig,
                             const SelfCalibrationOptions& options) {
  assert(idle());
  worker_.start([whole = std::move(whole), state, rig, options, is_finishing_early = is_finishing_early_,
                 page_file = page_file_] {
    const auto should_stop = releasing_pages(*page_file, [&] { return is_finishing_early->load(); });
    const auto refined = self_calibrate(*whole, state, rig, options, should_stop);
    if (!refined) return Refinement();
    Refinement result = recalibration_by(*refined, state, *whole, rig);
    page_file->release_pages();
    return result;
  });
}

std::optional<Recalibration> MapOptimiser::take_calibration() {
  if (!outcome_ || !std::holds_alternative<Refinement>(*outcome_)) return std::nullopt;
  return std::get<Refinement>(*std::exchange(outcome_, std::nullopt));
}

void MapOptimiser::collect() {
  store(worker_.collect());
}

void MapOptimiser::finish() {
  store(worker_.finish());
}

void MapOptimiser::store(std::optional<Worker<Outcome>::Finished> finished) {
  if (finished) outcome_ = std::move(finished->result);
}

AppliedCorrection MapOptimiser::apply(Map& online) {
  assert(is_waiting());
  MapDelta correction = std::get<MapDelta>(*std::exchange(outcome_, std::nullopt));
  LengthChanges changes = apply_correction(correction, *outline_, online);
  outline_.reset();
  return {std::move(correction), std::move(changes)};
}

}  // namespace byre
