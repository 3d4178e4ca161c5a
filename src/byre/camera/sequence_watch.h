#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <optional>

namespace byre {

// What became of the images that a device took.
struct CaptureCounts {
  int images = 0;        // images that were handed on
  int lost = 0;          // images that the driver took and had no room for, by gaps of its numbers
  int damaged = 0;       // images that the driver calls damaged, or that are cut
  int out_of_order = 0;  // images whose stamp is not later than that of the one before
};

// Counts images by the numbers and stamps that a driver gives them.
class SequenceWatch {
 public:
  // Whether the image is to be handed on.
  bool note(std::uint32_t sequence, Timestamp stamp);
  // The number counts on, so it is no gap.
  void note_damaged(std::uint32_t sequence);
  // The device was opened anew: its numbers begin again.
  void restart() { next_.reset(); }

  const CaptureCounts& counts() const { return counts_; }

 private:
  void note_number(std::uint32_t sequence);

  std::optional<std::uint32_t> next_;  // number that the next image should have
  std::optional<Timestamp> last_stamp_;
  CaptureCounts counts_;
};

}  // namespace byre
