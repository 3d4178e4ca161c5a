#pragma once

#include "byre/assessment/run_messages.h"
#include "byre/bag/mcap_writer.h"

#include <optional>

namespace byre {

// Writes the messages of a run into an MCAP file. All throw InputError when the file cannot be written; what was
// written before can be read.
class RunRecord {
 public:
  // with_images: images and camera info too, so that the file can be run again.
  RunRecord(McapWriter writer, const Calibration& calibration, bool with_images);

  RunRecord(const RunRecord&) = delete;
  RunRecord& operator=(const RunRecord&) = delete;

  // One of both after each frame, in order.
  void note(const RunView& view);              // where its images could be read
  void note_unread(const MappedFrame& frame);  // where they could not

  void finish(const MapRun& run);  // after the last: the final path and map

 private:
  McapWriter writer_;
  RunMessages messages_;  // written by the writer
  std::optional<Timestamp> flush_time_;
};

}  // namespace byre
