#pragma once

#include "byre/trajectory.h"

#include <deque>
#include <optional>
#include <utility>

namespace byre {

struct PairingOptions {
  bool has_second = true;
  Timestamp tolerance{};  // largest time between the stamps of a pair
  Timestamp wait{};       // time that a left image waits for its second image
};

struct PairingCounts {
  int skipped = 0;         // left images skipped for newer ones
  int without_second = 0;  // left images returned without a second image
};

// Pairs left images with second images, right or depth, by stamp. A caller that lags by one pair misses none; with more
// lag, the newest pair is returned. Arrival times are of one monotonic clock.
template <typename Image>
class ImagePairs {
 public:
  struct Pair {
    Timestamp stamp{};
    Image left;
    std::optional<Image> second;
    std::optional<Timestamp> nearest{};  // without a second image: distance to the nearest one's stamp
  };

  explicit ImagePairs(const PairingOptions& options) : options_(options) {}

  void add_left(Timestamp stamp, Image image, Timestamp arrival) { add(lefts_, stamp, std::move(image), arrival); }
  void add_second(Timestamp stamp, Image image, Timestamp arrival) { add(seconds_, stamp, std::move(image), arrival); }

  // Older one of two complete pairs, newest one of more; else the newest left image whose waiting time is over.
  std::optional<Pair> next(Timestamp now) {
    if (const auto left = next_complete()) return take(*left, partner_of(lefts_[*left].stamp));
    for (std::size_t i = lefts_.size(); i-- > 0;) {
      if (now - lefts_[i].arrival < options_.wait) continue;
      ++counts_.without_second;
      const std::optional<std::size_t> nearest = nearest_to(lefts_[i].stamp);
      const Timestamp stamp = lefts_[i].stamp;
      Pair pair = take(i, std::nullopt);
      if (nearest) pair.nearest = std::chrono::abs(seconds_[*nearest].stamp - stamp);
      return pair;
    }
    return std::nullopt;
  }

  const PairingCounts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kMaxWaiting = 8;
  struct Waiting {
    Timestamp stamp{};
    Image image;
    Timestamp arrival{};
  };
  using Queue = std::deque<Waiting>;

  void add(Queue& queue, Timestamp stamp, Image image, Timestamp arrival) {
    queue.push_back({stamp, std::move(image), arrival});
    if (queue.size() <= kMaxWaiting) return;
    queue.pop_front();
    if (&queue == &lefts_) ++counts_.skipped;
  }

  // Index of the left image of the next complete pair; empty if there is none.
  std::optional<std::size_t> next_complete() const {
    constexpr std::size_t kMaxBacklog = 2;  // complete pairs up to which none is skipped
    std::optional<std::size_t> newest, oldest;
    std::size_t count = 0;
    for (std::size_t i = lefts_.size(); i-- > 0;) {
      if (options_.has_second && !partner_of(lefts_[i].stamp)) continue;
      if (!newest) newest = i;
      oldest = i;
      ++count;
    }
    return count <= kMaxBacklog ? oldest : newest;
  }

  std::optional<std::size_t> nearest_to(Timestamp stamp) const {
    std::optional<std::size_t> best;
    const auto distance = [&](std::size_t i) { return std::chrono::abs(seconds_[i].stamp - stamp); };
    for (std::size_t i = 0; i < seconds_.size(); ++i) {
      if (!best || distance(i) < distance(*best)) best = i;
    }
    return best;
  }

  std::optional<std::size_t> partner_of(Timestamp stamp) const {
    const auto nearest = nearest_to(stamp);
    const bool is_near = nearest && std::chrono::abs(seconds_[*nearest].stamp - stamp) <= options_.tolerance;
    return is_near ? nearest : std::nullopt;
  }

  Pair take(std::size_t left, std::optional<std::size_t> second) {
    Pair pair{lefts_[left].stamp, std::move(lefts_[left].image), std::nullopt};
    if (second) pair.second = std::move(seconds_[*second].image);
    counts_.skipped += static_cast<int>(left);
    lefts_.erase(lefts_.begin(), lefts_.begin() + static_cast<std::ptrdiff_t>(left) + 1);
    if (second) seconds_.erase(seconds_.begin(), seconds_.begin() + static_cast<std::ptrdiff_t>(*second) + 1);
    return pair;
  }

  PairingOptions options_;
  Queue lefts_;    // in order of arrival
  Queue seconds_;  // in order of arrival
  PairingCounts counts_;
};

}  // namespace byre
