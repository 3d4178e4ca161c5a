#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <optional>

namespace byre {

struct CaptureCounts {
  int images = 0;        // images that were passed on
  int lost = 0;          // images that the driver dropped, by gaps of its sequence numbers
  int damaged = 0;       // images that the driver marks as damaged, or that are truncated
  int out_of_order = 0;  // images with a stamp not later than the previous one
};

// Counts images by a driver's sequence numbers and stamps.
class SequenceCounter {
 public:
  // Whether to pass the image on.
  bool note(std::uint32_t sequence, Timestamp stamp);
  // Advances the sequence number, so that the damaged image is not a gap.
  void note_damaged(std::uint32_t sequence);
  // The device was reopened: its sequence numbers restart.
  void restart() { next_.reset(); }

  const CaptureCounts& counts() const { return counts_; }

 private:
  void note_number(std::uint32_t sequence);

  std::optional<std::uint32_t> next_;  // expected number of the next image
  std::optional<Timestamp> last_stamp_;
  CaptureCounts counts_;
};

}  // namespace byre
