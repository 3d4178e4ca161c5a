#include "byre/io/recording/timed_files.h"

#include "byre/base/text_file.h"
#include "byre/floor_plan.h"
#include "byre/geometry/median.h"
#include "byre/io/bag/bag.h"
#include "byre/io/image/image_names.h"
#include "byre/recording.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

void add_if_exists(const fs::path& file, Files& files) {
  if (is_file(file)) files.push_back(file);
}

// Follows links to a limited depth, because links may be circular.
void add_below(const fs::path& folder, Files& files, int levels = 4) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (levels > 1 && is_folder(entry->path())) add_below(entry->path(), files, levels - 1);
    add_if_exists(entry->path(), files);
  }
}

// Files in a list in TUM's format; their paths may be anywhere.
void add_listed(const fs::path& list, Files& files) {
  try {
    if (!is_file(list)) return;
    for (const TextLine& line : read_lines(list)) {
      const std::vector<std::string_view> fields = split_fields(line.text);
      if (fields.size() >= 2) add_if_exists(list.parent_path() / fields[1], files);
    }
  } catch (const std::exception&) {  // not a list, so it names nothing
    return;
  }
}

bool is_folder_of_sensor(const fs::path& folder) {
  return is_file(folder / "sensor.yaml") || is_file(folder / "data.csv");
}

void add_euroc(const fs::path& mav, Files& files) {
  add_if_exists(mav / "body.yaml", files);
  std::error_code error;
  for (fs::directory_iterator entry(mav, error), end; !error && entry != end; entry.increment(error)) {
    if (is_folder_of_sensor(entry->path())) add_below(entry->path(), files);
  }
}

void add_images(const fs::path& folder, Files& files) {
  try {
    const Files images = images_in(folder);
    files.insert(files.end(), images.begin(), images.end());
  } catch (const fs::filesystem_error&) {  // unreadable folder
    return;
  }
}

void add_truth(const fs::path& recording, Files& files) {
  try {
    if (const std::optional<fs::path> truth = find_ground_truth(recording)) add_if_exists(*truth, files);
  } catch (const std::exception&) {  // not a recording, so it has none
    return;
  }
}

void add_bag(const fs::path& folder, Files& files) {
  try {
    for (const fs::path& file : files_of_bag(folder)) add_if_exists(file, files);
  } catch (const std::exception&) {  // unreadable folder
    return;
  }
}

void add_calibrations(const fs::path& folder, Files& files) {
  for (const char* const name : {"calibration.yaml", "camera.yaml", "sensor.yaml", "depth.yaml", "left.yaml",
                                 "right.yaml", "intrinsics.yml", "extrinsics.yml"}) {
    add_if_exists(folder / name, files);
  }
}

std::optional<fs::path> plan_image(const fs::path& plan) {
  try {
    const YAML::Node image = YAML::LoadFile(plan.string())["image"];
    if (image && image.IsScalar()) return plan.parent_path() / image.Scalar();
  } catch (const YAML::Exception&) {  // not a plan
  }
  return std::nullopt;
}

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

Files files_of_recording(const fs::path& recording) {
  Files files;
  if (!is_folder(recording)) {
    files.push_back(recording);
    if (is_file(recording) && (is_video_file(recording) || is_bag(recording))) {
      add_calibrations(recording.parent_path(), files);
    }
    return files;
  }
  if (is_bag(recording)) add_bag(recording, files);
  add_calibrations(recording, files);
  for (const char* const list : {"calib.txt", "times.txt", "rgb.txt", "depth.txt", "groundtruth.txt"}) {
    add_if_exists(recording / list, files);
  }
  for (const char* const folder : {"image_0", "image_1", "image_2", "image_3", "left", "right", "rgb", "depth"}) {
    if (is_folder(recording / folder)) add_below(recording / folder, files);
  }
  for (const char* const mav : {"mav0", "."}) add_euroc(recording / mav, files);
  for (const char* const list : {"rgb.txt", "depth.txt"}) add_listed(recording / list, files);
  add_images(recording, files);
  add_truth(recording, files);
  std::ranges::sort(files);
  const auto repeated = std::ranges::unique(files);
  files.erase(repeated.begin(), repeated.end());
  return files;
}

Files files_of_floor_plan(const fs::path& plan) {
  Files files = {plan};
  fs::path image = plan;
  if (!has_image_name(plan) && is_file(plan)) image = plan_image(plan).value_or(plan);
  if (image != plan) files.push_back(image);
  if (const std::optional<fs::path> world = find_world_file(image)) files.push_back(*world);
  return files;
}

Files files_of_colmap_model(const fs::path& folder) {
  Files files;
  for (const char* const name : {"cameras", "images", "points3D"}) {
    for (const char* const suffix : {".bin", ".txt"}) add_if_exists(folder / (std::string(name) + suffix), files);
  }
  return files;
}

Files images_below(const fs::path& folder) {
  if (!is_folder(folder)) return {folder};
  Files files;
  add_below(folder, files);
  std::erase_if(files, [](const fs::path& file) { return !has_image_name(file); });
  return files;
}

std::filesystem::path picks_path(const std::filesystem::path& map) {
  std::filesystem::path path = map;
  return path.replace_extension(".picks.csv");
}

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
