#pragma once

#include "byre/base/stopwatch.h"
#include "byre/map/map_file.h"

#include <functional>
#include <future>
#include <string>
#include <vector>

namespace byre {

// Saves the map at intervals of wall time. The calling thread only copies the map; another thread saves it. Skips a
// save while one is running.
class Autosave {
 public:
  using Save = std::function<void(StoredMap stored)>;  // stored.map is a copy of the online map

  Autosave(double interval_s, Save save) : interval_s_(interval_s), save_(std::move(save)) {}

  // Call it after each frame. metadata: StoredMap without keyframes and points, evaluated only when saving.
  void update(const MapGraph& online, const std::function<StoredMap()>& metadata);
  void finish();  // waits for the thread

  int saved() const { return saved_; }                                    // number of saves
  const std::vector<std::string>& failures() const { return failures_; }  // reasons of failed saves

 private:
  bool is_saving() const;

  // Constant after construction.
  double interval_s_;
  Save save_;

  // Owned by the calling thread.
  Stopwatch since_last_;
  std::future<void> saving_;
  int saved_ = 0;
  std::vector<std::string> failures_;
};

}  // namespace byre
