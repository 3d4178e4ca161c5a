#pragma once

#include "byre/image.h"

#include <cstddef>
#include <deque>
#include <optional>

namespace byre {

// An image and when its driver says that it was taken.
struct StampedImage {
  Timestamp stamp{};
  Image image;
};

struct PairingLimits {
  Timestamp tolerance = std::chrono::milliseconds(5);  // most time between the stamps of a pair
  Timestamp wait = std::chrono::milliseconds(200);     // time that a left image waits for its right one
};

struct StampPairCounts {
  int pairs = 0;
  int left_alone = 0;   // left images without a right one
  int right_alone = 0;  // right images without a left one, which are left out
};

// Puts the images of two devices together by their stamps, each left one with the nearest right one. All are kept in
// order, and a left image without a partner is handed on alone once none can come any more.
class StampPairing {
 public:
  struct Pair {
    StampedImage left;
    std::optional<StampedImage> right;
  };

  explicit StampPairing(const PairingLimits& limits) : limits_(limits) {}

  // now: when the image came, by a clock that never goes back.
  void add_left(StampedImage image, Timestamp now);
  void add_right(StampedImage image);

  std::optional<Pair> next(Timestamp now);

  const StampPairCounts& counts() const { return counts_; }
  // Time from the left image that was handed on last to the right one nearest to it, pair or not.
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
