#include "byre/camera/stamp_pairing.h"

#include <chrono>
#include <utility>

namespace byre {

namespace {

constexpr std::size_t kMaxRights = 32;  // right images kept while left ones are missing

}  // namespace

void StampPairing::add_left(StampedImage image, Timestamp now) {
  lefts_.push_back({std::move(image), now});
}

void StampPairing::add_right(StampedImage image) {
  rights_.push_back(std::move(image));
  if (rights_.size() <= kMaxRights) return;
  rights_.pop_front();
  ++counts_.unpaired_right;
}

std::optional<std::size_t> StampPairing::nearest_right(Timestamp stamp) const {
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < rights_.size(); ++i) {
    const auto distance = [&](std::size_t right) { return std::chrono::abs(rights_[right].stamp - stamp); };
    if (!nearest || distance(i) < distance(*nearest)) nearest = i;
  }
  return nearest;
}

std::optional<StampPairing::Pair> StampPairing::next(Timestamp now) {
  if (lefts_.empty()) return std::nullopt;
  const Timestamp stamp = lefts_.front().image.stamp;
  const auto nearest = nearest_right(stamp);
  if (nearest && std::chrono::abs(rights_[*nearest].stamp - stamp) <= limits_.tolerance) return take(nearest);
  const bool is_passed = !rights_.empty() && rights_.back().stamp > stamp + limits_.tolerance;
  const bool has_waited = now - lefts_.front().arrival >= limits_.wait;
  return is_passed || has_waited ? std::optional(take(std::nullopt)) : std::nullopt;
}

StampPairing::Pair StampPairing::take(std::optional<std::size_t> right) {
  const Timestamp stamp = lefts_.front().image.stamp;
  if (const auto nearest = nearest_right(stamp)) last_difference_ = rights_[*nearest].stamp - stamp;
  Pair pair{std::move(lefts_.front().image), std::nullopt};
  lefts_.pop_front();
  if (right) pair.right = std::move(rights_[*right]);
  std::size_t done = right ? *right + 1 : 0;
  while (done < rights_.size() && rights_[done].stamp < stamp - limits_.tolerance) ++done;
  counts_.unpaired_right += static_cast<int>(done) - (right ? 1 : 0);
  rights_.erase(rights_.begin(), rights_.begin() + static_cast<std::ptrdiff_t>(done));
  ++(right ? counts_.pairs : counts_.unpaired_left);
  return pair;
}

}  // namespace byre
