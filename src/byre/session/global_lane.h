#pragma once

#include "byre/session/executor.h"
#include "byre/slam/global_mapping.h"
#include "byre/slam/self_calibration.h"

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

namespace byre {

struct AppliedCorrection {
  MapDelta delta;
  LengthChanges length_changes;  // by which what lies relative to a keyframe is to follow
};

// Corrections of the whole map, and of its calibration, one at a time, beside tracking and local mapping. A finished
// correction waits until local mapping has nothing in flight, for what that works on would be out of date.
class GlobalLane {
 public:
  GlobalLane(std::unique_ptr<Executor> executor, const GlobalMappingOptions& options)
      : executor_(std::move(executor)), options_(options) {}

  bool idle() const { return !snapshot_ && executor_->idle() && !calibration_; }
  bool is_waiting() const { return correction_.has_value(); }  // with a finished correction

  // Bends the map to close these loops. Precondition: idle().
  void close_loops(const Map& map, const std::vector<LoopEdge>& loops);

  // Looks what the map says of the calibration of a rig of its. Precondition: idle().
  void calibrate(const MapView& map, const CalibrationState& state, int rig, const SelfCalibrationOptions& options);
  std::optional<RefinedCalibration> take_calibration();  // empty while there is none

  void collect();                        // once per frame
  void finish();                         // waits for the job in flight
  void hurry() { *is_hurried_ = true; }  // the job in flight, and those to come, end soon with what they have reached
  AppliedCorrection apply(Map& online);  // precondition: is_waiting()

 private:
  void note(FinishedJob finished);

  // Constant after construction.
  std::unique_ptr<Executor> executor_;
  GlobalMappingOptions options_;

  // Owned by the calling thread; the snapshot is shared with the job and changed by nobody.
  std::shared_ptr<const MapWindow> snapshot_;
  std::shared_ptr<std::atomic<bool>> is_hurried_ = std::make_shared<std::atomic<bool>>(false);  // read by the job
  std::optional<MapDelta> correction_;
  // Written by the job, read when that has been collected.
  std::shared_ptr<std::optional<RefinedCalibration>> calibration_;
  bool calibration_is_ready_ = false;
};

}  // namespace byre
