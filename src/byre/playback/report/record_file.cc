#include "byre/playback/report/record_file.h"

#include "byre/input_error.h"

#include <stdexcept>
#include <utility>

namespace byre {

RecordFile::RecordFile(std::optional<McapWriter> writer, const Calibration& calibration, bool with_images, Warn warn)
    : warn_(std::move(warn)) {
  if (writer) record_.emplace(std::move(*writer), calibration, with_images);
}

template <typename Write>
void RecordFile::attempt(Write write) {
  if (!record_ || fault_) return;
  try {
    write();
  } catch (const InputError& error) {
    fault_ = error.what();
    warn_(*fault_);
  }
}

void RecordFile::note(const RunView& view) {
  attempt([&] { record_->note(view); });
}

void RecordFile::note_unreadable(const PlayedFrame& frame) {
  attempt([&] { record_->note_unreadable(frame); });
}

void RecordFile::finish(const RunResult& run) {
  attempt([&] { record_->finish(run); });
}

void RecordFile::require_written() const {
  if (fault_) throw std::runtime_error(*fault_);
}

}  // namespace byre
