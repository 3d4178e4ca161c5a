#pragma once

#include "byre/system/engine.h"
#include "byre/workers/stopwatch.h"

#include <functional>
#include <future>
#include <string>
#include <vector>

namespace byre {

// Keeps the map so far, every so many seconds of wall time. Only copying the map takes time of the calling thread;
// saving has a thread of its own, and a map that comes due meanwhile is passed over.
class Autosave {
 public:
  using Save = std::function<void(const Map& online, const KeptWithMap& kept)>;

  Autosave(double interval_s, Save save) : interval_s_(interval_s), save_(std::move(save)) {}

  void offer(const Map& online, const KeptWithMap& kept);  // after each frame
  void finish();                                           // waits for the thread

  int saved() const { return saved_; }                                    // how often it was
  const std::vector<std::string>& failures() const { return failures_; }  // why it was not

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
