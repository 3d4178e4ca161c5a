#include "byre/camera/sequence_counter.h"

namespace byre {

// Numbers count modulo 2^32. A step back by less than half of it is a restart of the driver.
void SequenceCounter::note_number(std::uint32_t sequence) {
  constexpr std::uint32_t kHalf = 1u << 31;
  const std::uint32_t gap = sequence - next_.value_or(sequence);
  if (gap < kHalf) counts_.lost += static_cast<int>(gap);
  next_ = sequence + 1;
}

bool SequenceCounter::note(std::uint32_t sequence, Timestamp stamp) {
  note_number(sequence);
  if (last_stamp_ && stamp <= *last_stamp_) {
    ++counts_.out_of_order;
    return false;
  }
  last_stamp_ = stamp;
  ++counts_.images;
  return true;
}

void SequenceCounter::note_damaged(std::uint32_t sequence) {
  note_number(sequence);
  ++counts_.damaged;
}

}  // namespace byre
