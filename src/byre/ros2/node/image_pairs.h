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

// Pairs left images with second images, right or depth, by stamp. A caller that lags by one frame misses none; with
// more lag, the newest frame is returned. Arrival times are of one monotonic clock.
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

  // Older one of two frames that are ready, newest one of more.
  std::optional<Pair> next(Timestamp now) {
    const auto left = next_ready(now);
    if (!left) return std::nullopt;
    const Timestamp stamp = lefts_[*left].stamp;
    if (const auto partner = partner_of(stamp); partner || !options_.has_second) return take(*left, partner);
    ++counts_.without_second;
    const std::optional<std::size_t> nearest = nearest_to(stamp);
    Pair pair = take(*left, std::nullopt);
    if (nearest) pair.nearest = std::chrono::abs(seconds_[*nearest].stamp - stamp);
    return pair;
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

  // Index of the left image of the next frame; empty if none is ready. Ready are complete pairs, and left images whose
  // second image will not come: a newer pair is complete, as each topic is in order, or the waiting time is over.
  std::optional<std::size_t> next_ready(Timestamp now) const {
    constexpr std::size_t kMaxBacklog = 2;  // frames up to which none is skipped
    std::optional<std::size_t> newest, oldest;
    std::size_t count = 0;
    bool has_newer_pair = false;
    for (std::size_t i = lefts_.size(); i-- > 0;) {
      has_newer_pair = has_newer_pair || !options_.has_second || partner_of(lefts_[i].stamp);
      if (!has_newer_pair && now - lefts_[i].arrival < options_.wait) continue;
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
