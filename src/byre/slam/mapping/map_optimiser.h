#pragma once

#include "byre/base/scratch_file.h"
#include "byre/base/worker.h"
#include "byre/slam/calibration/self_calibration.h"
#include "byre/slam/loops/global_mapping.h"
#include "byre/slam/loops/odometry_motions.h"
#include "byre/slam/mapping/calibrator.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace byre {

struct AppliedCorrection {
  MapDelta delta;
  LengthChanges length_changes;  // for poses relative to keyframes
};

// Copy of the part of a map that loop closing deforms; see recent_map.
struct LoopClosureInput {
  std::shared_ptr<MapWindow> recent;
  std::shared_ptr<const MapWindow> outline;  // outline of `recent`
  std::vector<LoopEdge> loops;
};
// first_new: number of the first keyframe after those of a continued map; motions: see odometry_motions.
LoopClosureInput copy_for_loop_closure(const Map& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops,
                                       const std::vector<KeyframeMotion>& motions);

// Corrections of the whole map and of its calibration, one at a time, in parallel with tracking and local mapping. A
// finished correction waits until no local job is in flight, because it would invalidate the job's window.
class MapOptimiser {
 public:
  // page_file: file with features of the maps.
  MapOptimiser(std::unique_ptr<Executor> executor, const GlobalMappingOptions& options,
               std::shared_ptr<const ScratchFile> page_file)
      : options_(options), page_file_(std::move(page_file)), worker_(std::move(executor)) {}

  bool idle() const { return worker_.idle() && !outcome_; }
  bool is_waiting() const { return outcome_ && std::holds_alternative<MapDelta>(*outcome_); }  // to apply a correction

  void close_loops(LoopClosureInput map);  // precondition: idle()
  // Refines the calibration of a rig by the map. Precondition: idle().
  void calibrate(std::shared_ptr<const MapWindow> whole, const CalibrationState& state, int rig,
                 const SelfCalibrationOptions& options);
  std::optional<Recalibration> take_calibration();  // empty if none is finished

  void collect();  // once per frame
  void finish();   // waits for the job in flight
  void finish_early() {
    *is_finishing_early_ = true;
  }                                      // the present job and later ones end soon, with their results so far
  AppliedCorrection apply(Map& online);  // precondition: is_waiting()

 private:
  using Refinement = std::optional<Recalibration>;
  using Outcome = std::variant<MapDelta, Refinement>;

  void store(std::optional<Worker<Outcome>::Finished> finished);

  GlobalMappingOptions options_;                  // constant after construction, as is the next
  std::shared_ptr<const ScratchFile> page_file_;  // shared with jobs

  // Owned by the calling thread; the outline is shared with the job and constant.
  Worker<Outcome> worker_;
  std::shared_ptr<const MapWindow> outline_;  // outline of the map before the correction
  std::shared_ptr<std::atomic<bool>> is_finishing_early_ =
      std::make_shared<std::atomic<bool>>(false);  // read by the job
  std::optional<Outcome> outcome_;                 // not yet applied
};

}  // namespace byre
