#pragma once

#include "byre/mapping/calibrator.h"
#include "byre/slam/global_mapping.h"
#include "byre/slam/self_calibration.h"
#include "byre/slam/told_motions.h"
#include "byre/workers/scratch_file.h"
#include "byre/workers/worker.h"

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
  LengthChanges length_changes;  // what lies relative to a keyframe is to follow them
};

// The part of a map that closing loops bends, copied from it; see recent_map.
struct MapToBend {
  std::shared_ptr<MapWindow> recent;
  std::shared_ptr<const MapWindow> outline;  // the recent map's
  std::vector<LoopEdge> loops;
};
// first_new: number of the first keyframe that is not of the map gone on with; motions: see told_motions.
MapToBend copy_to_bend(const Map& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops,
                       const std::vector<KeyframeMotion>& motions);

// Corrections of the whole map, and of its calibration, one at a time, beside tracking and local mapping. A finished
// correction waits until local mapping has nothing in flight, for what that works on would be out of date.
class GlobalLane {
 public:
  // stowed: where features of the maps lie that are corrected.
  GlobalLane(std::unique_ptr<Executor> executor, const GlobalMappingOptions& options,
             std::shared_ptr<const ScratchFile> stowed)
      : options_(options), stowed_(std::move(stowed)), worker_(std::move(executor)) {}

  bool idle() const { return worker_.idle() && !outcome_; }
  bool is_waiting() const { return outcome_ && std::holds_alternative<MapDelta>(*outcome_); }  // with a correction

  void close_loops(MapToBend map);  // precondition: idle()
  // Looks what a map says of the calibration of a rig of its. Precondition: idle().
  void calibrate(std::shared_ptr<const MapWindow> whole, const CalibrationState& state, int rig,
                 const SelfCalibrationOptions& options);
  std::optional<Recalibration> take_calibration();  // empty while there is none

  void collect();                        // once per frame
  void finish();                         // waits for the job in flight
  void hurry() { *is_hurried_ = true; }  // the job in flight, and those to come, end soon with what they have reached
  AppliedCorrection apply(Map& online);  // precondition: is_waiting()

 private:
  using Refinement = std::optional<Recalibration>;
  using Outcome = std::variant<MapDelta, Refinement>;

  void keep(std::optional<Worker<Outcome>::Finished> finished);

  GlobalMappingOptions options_;               // constant after construction, as the next
  std::shared_ptr<const ScratchFile> stowed_;  // shared with jobs

  // Owned by the calling thread; the outline is shared with the job and changed by nobody.
  Worker<Outcome> worker_;
  std::shared_ptr<const MapWindow> outline_;  // map that is corrected, as it was
  std::shared_ptr<std::atomic<bool>> is_hurried_ = std::make_shared<std::atomic<bool>>(false);  // read by the job
  std::optional<Outcome> outcome_;                                                              // not taken over yet
};

}  // namespace byre
