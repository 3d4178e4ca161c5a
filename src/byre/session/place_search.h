#pragma once

#include "byre/session/executor.h"
#include "byre/slam/localisation.h"
#include "byre/slam/offline_map.h"

#include <memory>
#include <optional>

namespace byre {

// Where the offline map shows what a frame saw.
struct FoundPlace {
  std::size_t frame = 0;  // the caller's number of the frame
  Pose camera_from_offline;
  double median_depth = 0.0;  // metres, of the points that say so
  double seen_share = 0.0;    // of those that should be in view there
};

// Looks for frames in the offline map beside tracking, one at a time, each without a guess.
class PlaceSearch {
 public:
  PlaceSearch(std::unique_ptr<Executor> executor, std::shared_ptr<const OfflineMap> offline,
              const LocaliseOptions& options)
      : executor_(std::move(executor)), offline_(std::move(offline)), options_(options) {}

  bool idle() const { return executor_->idle(); }
  void look_for(const Frame& frame, const Rig& rig, std::size_t number);  // precondition: idle()
  std::optional<FoundPlace> collect();  // once per frame; empty also when the frame was not found
  void finish();                        // waits for the search in flight and forgets what it finds

 private:
  // Constant after construction.
  std::unique_ptr<Executor> executor_;
  std::shared_ptr<const OfflineMap> offline_;
  LocaliseOptions options_;

  // Written by the job, read when that has been collected.
  std::shared_ptr<std::optional<FoundPlace>> result_;
};

// The frame in the offline map alone.
Localisation localise_in(const OfflineMap& offline, const Frame& frame, const Rig& rig, const LocaliseOptions& options);

}  // namespace byre
