#pragma once

#include "byre/image.h"

#include <cstddef>
#include <deque>
#include <optional>

namespace byre {

// An image and its time stamp by the driver.
struct StampedImage {
  Timestamp stamp{};
  Image image;
};

struct PairingLimits {
  Timestamp tolerance = std::chrono::milliseconds(5);  // largest difference between the stamps of a pair
  Timestamp wait = std::chrono::milliseconds(200);     // longest time that a left image waits for its right one
};

struct StampPairCounts {
  int pairs = 0;
  int unpaired_left = 0;   // left images without a right one
  int unpaired_right = 0;  // right images without a left one, which are dropped
};

// Pairs the images of two devices by their stamps: each left image with the nearest right one. The order is kept. A
// left image is passed on alone once no partner can arrive any more.
class StampPairing {
 public:
  struct Pair {
    StampedImage left;
    std::optional<StampedImage> right;
  };

  explicit StampPairing(const PairingLimits& limits) : limits_(limits) {}

  // now: arrival time, by a monotonic clock.
  void add_left(StampedImage image, Timestamp now);
  void add_right(StampedImage image);

  std::optional<Pair> next(Timestamp now);

  const StampPairCounts& counts() const { return counts_; }
  // Time from the last left image passed on to its nearest right image, paired or not.
  std::optional<Timestamp> last_difference() const { return last_difference_; }

 private:
  struct Waiting {
    StampedImage image;
    Timestamp arrival{};
  };

  std::optional<std::size_t> nearest_right(Timestamp stamp) const;
  Pair take(std::optional<std::size_t> right);

  PairingLimits limits_;  // constant after construction
  std::deque<Waiting> lefts_;
  std::deque<StampedImage> rights_;
  StampPairCounts counts_;
  std::optional<Timestamp> last_difference_;
};

}  // namespace byre
