#include "byre/io/recording/timed_files.h"

#include "byre/geometry/median.h"
#include "byre/input_error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

Timestamp time_of(Timestamp time) {
  return time;
}

template <typename Item>
Timestamp time_of(const Item& item) {
  return item.time;
}

// The item nearest in time within the tolerance, else the end. Precondition: items ascend in time.
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

// Median of the times from each image to the nearest one of the other camera.
Timestamp median_difference(const std::vector<Timestamp>& left, const std::vector<Timestamp>& right) {
  std::vector<Timestamp> differences;
  for (const Timestamp time : left) {
    differences.push_back(std::chrono::abs(*find_nearest(right, time, Timestamp::max()) - time));
  }
  return median(std::move(differences));
}

}  // namespace

Timestamp pair_tolerance(const OpenOptions& options) {
  return options.pair_tolerance_s ? from_seconds(*options.pair_tolerance_s) : kDefaultPairTolerance;
}

void require_times(std::size_t kept, int repeated, const std::string& place) {
  if (kept > 1 || repeated == 0) return;
  throw InputError(
      place, "all of its " + std::to_string(repeated + 1) + " images have the same time stamp",
      "stamp images with a running clock, or extract them into a folder and give the frame rate with --fps");
}

RestoredFiles restore_files(const std::vector<TimedFile>& listed, const std::string& place, const SensorClock& other) {
  RecordedStamps recorded;
  std::vector<TimedFile> distinct;
  for (const TimedFile& file : listed) {
    if (!distinct.empty() && distinct.back().time == file.time && distinct.back().path == file.path) continue;
    distinct.push_back(file);
    recorded.stamps.push_back(file.time);
  }
  RestoredTimes restored = restore_times(recorded, other);
  RestoredFiles result{{}, std::move(restored.corrections), std::move(restored.clock), {}};
  require_times(restored.items.size(), result.corrections.repeated, place);
  result.corrections.repeated += static_cast<int>(listed.size() - distinct.size());
  for (std::size_t i = 0; i < restored.items.size(); ++i) {
    result.files.push_back({restored.times[i], std::move(distinct[restored.items[i]].path)});
  }
  result.warnings = describe(result.corrections, {place, "image", "frame"});
  return result;
}

std::vector<std::optional<std::size_t>> match_by_time(const std::vector<Timestamp>& times,
                                                      const std::vector<Timestamp>& others, Timestamp tolerance) {
  std::vector<std::optional<std::size_t>> partners;
  for (const Timestamp time : times) {
    const auto partner = find_nearest(others, time, tolerance);
    const auto number = static_cast<std::size_t>(partner - others.begin());
    partners.push_back(partner == others.end() ? std::nullopt : std::optional(number));
  }
  return partners;
}

std::vector<FrameFiles> frames_of(const std::vector<TimedFile>& left, const std::vector<TimedFile>& right,
                                  Timestamp tolerance) {
  std::vector<FrameFiles> frames;
  const std::vector<std::optional<std::size_t>> partners =
      match_by_time(times_of_files(left), times_of_files(right), tolerance);
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

void require_pairs(const std::vector<FrameFiles>& frames, const std::vector<TimedFile>& right, Timestamp tolerance,
                   const std::string& place) {
  if (std::ranges::any_of(frames, [](const FrameFiles& frame) { return frame.right.has_value(); })) return;
  std::vector<Timestamp> left;
  for (const FrameFiles& frame : frames) left.push_back(frame.time);
  throw no_pairs_error(place, left, times_of_files(right), tolerance);
}

InputError no_pairs_error(const std::string& place, const std::vector<Timestamp>& left,
                          const std::vector<Timestamp>& right, Timestamp tolerance) {
  constexpr double kLikelyOnePair = 0.1;  // seconds
  const double difference = to_seconds(median_difference(left, right));
  const std::string reason =
      fmt::format("no right image is within {:g} ms of a left image; the median difference is {:.3f} ms",
                  1e3 * to_seconds(tolerance), 1e3 * difference);
  if (difference > kLikelyOnePair) {
    return {place, reason, "check that both cameras use one clock, or use the left camera alone: --camera left"};
  }
  return {place, reason,
          fmt::format("trigger both cameras together; if the images are pairs, accept the difference with "
                      "--pair-tolerance {:.3f}; or "
                      "use the left camera alone: --camera left",
                      std::ceil(1e3 * difference + 1.0) / 1e3)};
}

}  // namespace byre
