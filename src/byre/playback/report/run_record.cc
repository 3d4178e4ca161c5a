#include "byre/playback/report/run_record.h"

#include "byre/input_error.h"

#include <stdexcept>
#include <utility>

namespace byre {

RunRecord::RunRecord(std::optional<McapWriter> writer, const Calibration& calibration, bool with_images, Warn warn)
    : warn_(std::move(warn)), writer_(std::move(writer)) {
  if (writer_) messages_.emplace(*writer_, calibration, RunMessageOptions{.with_images = with_images});
}

template <typename Write>
void RunRecord::attempt(Write write) {
  if (!messages_ || fault_) return;
  try {
    write();
  } catch (const InputError& error) {
    fault_ = error.what();
    warn_(*fault_);
  }
}

void RunRecord::note(const RunView& view) {
  constexpr Timestamp kFlushInterval = std::chrono::seconds(1);
  attempt([&] {
    messages_->note(view);
    const Timestamp time = view.frame.time;
    if (flush_time_ && time - *flush_time_ < kFlushInterval) return;
    writer_->flush();
    flush_time_ = time;
  });
}

void RunRecord::note_unreadable(const PlayedFrame& frame) {
  attempt([&] { messages_->note_unreadable(frame); });
}

void RunRecord::finish(const RunResult& run) {
  attempt([&] {
    messages_->finish(run);
    writer_->close();
  });
}

void RunRecord::require_written() const {
  if (fault_) throw std::runtime_error(*fault_);
}

}  // namespace byre
