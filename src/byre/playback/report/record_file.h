#pragma once

#include "byre/playback/report/run_record.h"

#include <functional>
#include <optional>
#include <string>

namespace byre {

// Optional MCAP file of a run. Messages are written during the run, so an aborted run leaves a readable file. A write
// failure is reported once by warn, and the run continues.
class RecordFile {
 public:
  using Warn = std::function<void(const std::string& fault)>;

  RecordFile(std::optional<McapWriter> writer, const Calibration& calibration, bool with_images, Warn warn);

  bool is_wanted() const { return record_.has_value(); }
  void note(const RunView& view);                  // call after each frame with readable images
  void note_unreadable(const PlayedFrame& frame);  // call after each other frame
  void finish(const RunResult& run);
  void require_written() const;

 private:
  template <typename Write>
  void attempt(Write write);

  Warn warn_;
  std::optional<RunRecord> record_;
  std::optional<std::string> fault_;
};

}  // namespace byre
