#pragma once

#include "byre/trajectory.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <optional>
#include <utility>

namespace byre {

struct PairingOptions {
  bool has_right = true;
  Timestamp tolerance{};  // most time between the stamps of a pair
  Timestamp wait{};       // time that a left image waits for its right one
};

struct PairingCounts {
  int passed_over = 0;    // left images that were left out, as a newer one was there
  int without_right = 0;  // left images that were handed over alone
};

// Puts left and right images together by their stamps. Whoever asks late by one pair misses none; by more, the newest
// wins.
// Times of arrival are those of one clock that never goes back.
template <typename Image>
class ImagePairs {
 public:
  struct Pair {
    Timestamp stamp{};
    Image left;
    std::optional<Image> right;
    std::optional<Timestamp>
        nearest{};  // where there is no right image: distance to the stamp of the nearest right one
  };

  explicit ImagePairs(const PairingOptions& options) : options_(options) {}

  void add_left(Timestamp stamp, Image image, Timestamp arrival) { add(lefts_, stamp, std::move(image), arrival); }
  void add_right(Timestamp stamp, Image image, Timestamp arrival) { add(rights_, stamp, std::move(image), arrival); }

  // The older one of two complete pairs, the newest of more; else the newest left image that has waited long enough.
  std::optional<Pair> next(Timestamp now) {
    if (const auto left = next_whole()) return take(*left, partner_of(lefts_[*left].stamp));
    for (std::size_t i = lefts_.size(); i-- > 0;) {
      if (now - lefts_[i].arrival < options_.wait) continue;
      ++counts_.without_right;
      const std::optional<std::size_t> nearest = nearest_to(lefts_[i].stamp);
      const Timestamp stamp = lefts_[i].stamp;
      Pair pair = take(i, std::nullopt);
      if (nearest) pair.nearest = std::chrono::abs(rights_[*nearest].stamp - stamp);
      return pair;
    }
    return std::nullopt;
  }

  const PairingCounts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kMostWaiting = 8;
  struct Waiting {
    Timestamp stamp{};
    Image image;
    Timestamp arrival{};
  };
  using Queue = std::deque<Waiting>;

  void add(Queue& queue, Timestamp stamp, Image image, Timestamp arrival) {
    queue.push_back({stamp, std::move(image), arrival});
    if (queue.size() <= kMostWaiting) return;
    queue.pop_front();
    if (&queue == &lefts_) ++counts_.passed_over;
  }

  // Index of the left image whose pair comes next; empty where none is complete.
  std::optional<std::size_t> next_whole() const {
    constexpr std::size_t kCaughtUp = 2;  // complete pairs, of which none is left out
    std::optional<std::size_t> newest, oldest;
    std::size_t count = 0;
    for (std::size_t i = lefts_.size(); i-- > 0;) {
      if (options_.has_right && !partner_of(lefts_[i].stamp)) continue;
      if (!newest) newest = i;
      oldest = i;
      ++count;
    }
    return count <= kCaughtUp ? oldest : newest;
  }

  std::optional<std::size_t> nearest_to(Timestamp stamp) const {
    std::optional<std::size_t> best;
    const auto distance = [&](std::size_t i) { return std::chrono::abs(rights_[i].stamp - stamp); };
    for (std::size_t i = 0; i < rights_.size(); ++i) {
      if (!best || distance(i) < distance(*best)) best = i;
    }
    return best;
  }

  std::optional<std::size_t> partner_of(Timestamp stamp) const {
    const auto nearest = nearest_to(stamp);
    const bool is_near = nearest && std::chrono::abs(rights_[*nearest].stamp - stamp) <= options_.tolerance;
    return is_near ? nearest : std::nullopt;
  }

  Pair take(std::size_t left, std::optional<std::size_t> right) {
    Pair pair{lefts_[left].stamp, std::move(lefts_[left].image), std::nullopt};
    if (right) pair.right = std::move(rights_[*right].image);
    counts_.passed_over += static_cast<int>(left);
    lefts_.erase(lefts_.begin(), lefts_.begin() + static_cast<std::ptrdiff_t>(left) + 1);
    if (right) rights_.erase(rights_.begin(), rights_.begin() + static_cast<std::ptrdiff_t>(*right) + 1);
    return pair;
  }

  PairingOptions options_;
  Queue lefts_;   // in the order of arrival
  Queue rights_;  // in the order of arrival
  PairingCounts counts_;
};

}  // namespace byre
