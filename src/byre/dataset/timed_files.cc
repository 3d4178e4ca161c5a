#include "byre/dataset/timed_files.h"

#include "byre/input/input_error.h"

#include <algorithm>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr Timestamp kPairTolerance = std::chrono::milliseconds(2);

// The file taken at nearly the same time. Precondition: files ascend in time.
std::optional<fs::path> partner_of(Timestamp time, const std::vector<TimedFile>& files) {
  const auto before = [](const TimedFile& file, Timestamp t) { return file.time < t; };
  auto nearest = std::lower_bound(files.begin(), files.end(), time, before);
  if (nearest != files.begin() && (nearest == files.end() || time - std::prev(nearest)->time < nearest->time - time)) {
    --nearest;
  }
  if (nearest == files.end() || std::chrono::abs(nearest->time - time) > kPairTolerance) return std::nullopt;
  return nearest->path;
}

}  // namespace

std::vector<fs::path> paths_of(const std::vector<TimedFile>& files) {
  std::vector<fs::path> paths;
  for (const TimedFile& file : files) paths.push_back(file.path);
  return paths;
}

std::vector<FrameFiles> frames_of(const std::vector<TimedFile>& left, const std::vector<TimedFile>& right) {
  std::vector<FrameFiles> frames;
  for (const TimedFile& file : left) frames.push_back({file.time, file.path, partner_of(file.time, right)});
  return frames;
}

void require_pairs(const std::vector<FrameFiles>& frames, const std::string& place) {
  if (std::ranges::any_of(frames, [](const FrameFiles& frame) { return frame.right.has_value(); })) return;
  throw InputError(place, "no image was taken within 2 ms of any of the left camera",
                   "check that both cameras use one clock, or take the left camera alone");
}

}  // namespace byre
