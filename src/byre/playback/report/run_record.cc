#include "byre/playback/report/run_record.h"

#include <utility>

namespace byre {
namespace {

constexpr Timestamp kFlushInterval = std::chrono::seconds(1);

}  // namespace

RunRecord::RunRecord(McapWriter writer, const Calibration& calibration, bool with_images)
    : writer_(std::move(writer)), messages_(writer_, calibration, {.with_images = with_images}) {}

void RunRecord::note(const RunView& view) {
  messages_.note(view);
  const Timestamp time = view.frame.time;
  if (flush_time_ && time - *flush_time_ < kFlushInterval) return;
  writer_.flush();
  flush_time_ = time;
}

void RunRecord::note_unreadable(const PlayedFrame& frame) {
  messages_.note_unreadable(frame);
}

void RunRecord::finish(const RunResult& run) {
  messages_.finish(run);
  writer_.close();
}

}  // namespace byre
