#include "byre/playback/decode_ahead.h"

#include "byre/base/stopwatch.h"

#include <exception>
#include <string>
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

DecodedFrame DecodeAhead::decode(int index) {
  const Stopwatch watch;
  DecodedFrame slot;
  slot.time = recording_.times()[static_cast<std::size_t>(index)];
  const auto warned_before = static_cast<std::ptrdiff_t>(recording_.warnings().size());
  std::string failure;
  try {
    slot.images = recording_.read(index);
  } catch (const std::exception& error) {
    failure = error.what();
  }
  const std::vector<std::string>& warnings = recording_.warnings();
  slot.warnings.assign(warnings.begin() + warned_before, warnings.end());
  if (!failure.empty()) slot.warnings.push_back("frame " + std::to_string(index) + " is skipped: " + failure);
  slot.seconds = watch.seconds();
  return slot;
}

std::optional<DecodedFrame> DecodeAhead::next() {
  if (taken_ == recording_.size()) return std::nullopt;
  filled_.acquire();
  DecodedFrame frame = std::exchange(slot_of(taken_++), {});
  free_.release();
  return frame;
}

}  // namespace byre
