#include "byre/playback/decode_ahead.h"

#include "byre/workers/stopwatch.h"

#include <utility>

namespace byre {

DecodeAhead::DecodeAhead(Recording& recording)
    : recording_(recording), thread_([this](const std::stop_token& stop) { decode_all(stop); }) {}

DecodeAhead::~DecodeAhead() {
  thread_.request_stop();
  free_.release();
}

void DecodeAhead::decode_all(const std::stop_token& stop) {
  for (int index = 0; index < recording_.size(); ++index) {
    free_.acquire();
    if (stop.stop_requested()) return;
    slot_of(index) = decode(index);
    filled_.release();
  }
}

DecodeAhead::Slot DecodeAhead::decode(int index) {
  const Stopwatch watch;
  Slot slot;
  slot.frame.time = recording_.times()[static_cast<std::size_t>(index)];
  const auto warned_before = static_cast<std::ptrdiff_t>(recording_.warnings().size());
  try {
    slot.frame.images = recording_.read(index);
  } catch (...) {
    slot.failure = std::current_exception();
  }
  const std::vector<std::string>& warnings = recording_.warnings();
  slot.frame.warnings.assign(warnings.begin() + warned_before, warnings.end());
  slot.frame.seconds = watch.seconds();
  return slot;
}

std::optional<DecodedFrame> DecodeAhead::next() {
  if (taken_ == recording_.size()) return std::nullopt;
  filled_.acquire();
  Slot slot = std::exchange(slot_of(taken_++), {});
  free_.release();
  if (slot.failure) std::rethrow_exception(slot.failure);
  return std::move(slot.frame);
}

}  // namespace byre
