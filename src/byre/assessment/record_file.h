#pragma once

#include "byre/assessment/run_record.h"

#include <functional>
#include <optional>
#include <string>

namespace byre {

// The file that a run is recorded in, where one is asked for. It is written as the run goes on, so that what is known
// of it is kept however it ends. That it cannot be written any more is told at once, and the run goes on.
class RecordFile {
 public:
  using Warn = std::function<void(const std::string& fault)>;

  RecordFile(std::optional<McapWriter> writer, const Calibration& calibration, bool with_images, Warn warn);

  bool is_wanted() const { return record_.has_value(); }
  void note(const RunView& view);              // after each frame whose images could be read
  void note_unread(const MappedFrame& frame);  // after each other one
  void finish(const MapRun& run);
  void require_written() const;  // throws when anything is missing

 private:
  template <typename Write>
  void attempt(Write write);

  Warn warn_;
  std::optional<RunRecord> record_;  // empty: nothing is recorded
  std::optional<std::string> fault_;
};

}  // namespace byre
