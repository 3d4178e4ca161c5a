#include "byre/dataset/timed_files.h"

#include "byre/input_error.h"

#include <algorithm>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr Timestamp kPairTolerance = std::chrono::milliseconds(2);
constexpr Timestamp kDepthTolerance = std::chrono::milliseconds(20);

// The one nearest in time, when it is within the tolerance; else the end. Precondition: they ascend in time.
template <typename Range>
auto find_nearest(Range& items, Timestamp time, Timestamp tolerance) {
  const auto before = [](const auto& item, Timestamp t) { return item.time < t; };
  auto nearest = std::lower_bound(items.begin(), items.end(), time, before);
  if (nearest != items.begin() && (nearest == items.end() || time - std::prev(nearest)->time < nearest->time - time)) {
    --nearest;
  }
  const bool is_near = nearest != items.end() && std::chrono::abs(nearest->time - time) <= tolerance;
  return is_near ? nearest : items.end();
}

// The file taken at nearly the same time. Precondition: files ascend in time.
std::optional<fs::path> partner_of(Timestamp time, const std::vector<TimedFile>& files) {
  const auto partner = find_nearest(files, time, kPairTolerance);
  return partner == files.end() ? std::nullopt : std::optional(partner->path);
}

}  // namespace

std::vector<FrameFiles> frames_of(const std::vector<TimedFile>& left, const std::vector<TimedFile>& right) {
  std::vector<FrameFiles> frames;
  for (const TimedFile& file : left) frames.push_back({file.time, file.path, partner_of(file.time, right)});
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
