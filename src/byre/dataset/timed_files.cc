#include "byre/dataset/timed_files.h"

#include "byre/input_error.h"

#include <algorithm>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr Timestamp kPairTolerance = std::chrono::milliseconds(2);
constexpr Timestamp kDepthTolerance = std::chrono::milliseconds(20);

Timestamp time_of(Timestamp time) {
  return time;
}

template <typename Item>
Timestamp time_of(const Item& item) {
  return item.time;
}

// The one nearest in time, when it is within the tolerance; else the end. Precondition: they ascend in time.
template <typename Range>
auto find_nearest(Range& items, Timestamp time, Timestamp tolerance) {
  const auto before = [](const auto& item, Timestamp t) { return time_of(item) < t; };
  auto nearest = std::lower_bound(items.begin(), items.end(), time, before);
  if (nearest != items.begin() &&
      (nearest == items.end() || time - time_of(*std::prev(nearest)) < time_of(*nearest) - time)) {
    --nearest;
  }
  const bool is_near = nearest != items.end() && std::chrono::abs(time_of(*nearest) - time) <= tolerance;
  return is_near ? nearest : items.end();
}

std::vector<Timestamp> times_of_files(const std::vector<TimedFile>& files) {
  std::vector<Timestamp> times;
  for (const TimedFile& file : files) times.push_back(file.time);
  return times;
}

}  // namespace

std::vector<std::optional<std::size_t>> partners_in_time(const std::vector<Timestamp>& times,
                                                         const std::vector<Timestamp>& others) {
  std::vector<std::optional<std::size_t>> partners;
  for (const Timestamp time : times) {
    const auto partner = find_nearest(others, time, kPairTolerance);
    const auto number = static_cast<std::size_t>(partner - others.begin());
    partners.push_back(partner == others.end() ? std::nullopt : std::optional(number));
  }
  return partners;
}

std::vector<FrameFiles> frames_of(const std::vector<TimedFile>& left, const std::vector<TimedFile>& right) {
  std::vector<FrameFiles> frames;
  const std::vector<std::optional<std::size_t>> partners =
      partners_in_time(times_of_files(left), times_of_files(right));
  for (std::size_t i = 0; i < left.size(); ++i) {
    frames.push_back({left[i].time, left[i].path, std::nullopt});
    if (partners[i]) frames.back().right = right[*partners[i]].path;
  }
  return frames;
}

void add_depth(std::vector<FrameFiles>& frames, const std::vector<TimedFile>& depth) {
  std::vector<std::optional<Timestamp>> gaps(frames.size());
  for (const TimedFile& file : depth) {
    const auto frame = find_nearest(frames, file.time, kDepthTolerance);
    if (frame == frames.end()) continue;
    const Timestamp gap = std::chrono::abs(frame->time - file.time);
    std::optional<Timestamp>& least = gaps[static_cast<std::size_t>(frame - frames.begin())];
    if (least && *least <= gap) continue;
    least = gap;
    frame->depth = file.path;
  }
}

void require_pairs(const std::vector<FrameFiles>& frames, const std::string& place) {
  if (std::ranges::any_of(frames, [](const FrameFiles& frame) { return frame.right.has_value(); })) return;
  throw InputError(place, "no image was taken within 2 ms of any of the left camera",
                   "check that both cameras use one clock, or take the left camera alone");
}

}  // namespace byre
