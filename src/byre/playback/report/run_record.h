#pragma once

#include "byre/io/bag/mcap_writer.h"
#include "byre/playback/report/run_messages.h"

#include <optional>

namespace byre {

// Writes the messages of a run into an MCAP file. All functions throw InputError when the file cannot be written;
// earlier messages stay readable.
class RunRecord {
 public:
  // with_images: includes images and camera info, so that the file can be replayed as a recording.
  RunRecord(McapWriter writer, const Calibration& calibration, bool with_images);

  RunRecord(const RunRecord&) = delete;
  RunRecord& operator=(const RunRecord&) = delete;

  // Call one of the two after each frame, in order.
  void note(const RunView& view);                  // frame with readable images
  void note_unreadable(const PlayedFrame& frame);  // frame without

  void finish(const RunResult& run);  // call after the last frame: writes final path and map

 private:
  McapWriter writer_;
  RunMessages messages_;
  std::optional<Timestamp> flush_time_;
};

}  // namespace byre
