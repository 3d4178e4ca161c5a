#pragma once

#include "byre/io/bag/mcap_writer.h"
#include "byre/playback/report/run_messages.h"

#include <functional>
#include <optional>
#include <string>

namespace byre {

// Optional MCAP file of a run. Messages are written during the run, so an aborted run leaves a readable file. A write
// failure is reported once by warn, and the run continues.
class RunRecord {
 public:
  using Warn = std::function<void(const std::string& fault)>;

  // with_images: includes images and camera info, so that the file can be replayed as a recording.
  RunRecord(std::optional<McapWriter> writer, const Calibration& calibration, bool with_images, Warn warn);
  RunRecord(const RunRecord&) = delete;
  RunRecord& operator=(const RunRecord&) = delete;

  bool is_wanted() const { return messages_.has_value(); }
  // Call one of the two after each frame, in order.
  void note(const RunView& view);                  // frame with readable images
  void note_unreadable(const PlayedFrame& frame);  // frame without
  void finish(const RunResult& run);               // call after the last frame: writes final path and map
  // Throws std::runtime_error after a write failure; earlier messages are readable.
  void require_written() const;

 private:
  template <typename Write>
  void attempt(Write write);

  Warn warn_;
  std::optional<McapWriter> writer_;
  std::optional<RunMessages> messages_;  // with a writer
  std::optional<Timestamp> flush_time_;
  std::optional<std::string> fault_;
};

}  // namespace byre
