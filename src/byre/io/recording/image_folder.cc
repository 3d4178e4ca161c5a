#include "byre/input_error.h"
#include "byre/io/image/image_names.h"
#include "byre/io/recording/recording_index.h"
#include "byre/io/recording/timed_files.h"

#include <algorithm>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRateWarning = "image names are not time stamps; 30 frames per second are assumed";

struct ImageFolders {
  fs::path left;
  std::optional<fs::path> right;
};

ImageFolders folders_of(const fs::path& folder) {
  if (images_in(folder / "left").empty() || images_in(folder / "right").empty()) return {folder, std::nullopt};
  return {folder / "left", folder / "right"};
}

std::vector<TimedFile> with_times(const std::vector<fs::path>& files, const std::vector<Timestamp>& times) {
  std::vector<TimedFile> timed;
  for (std::size_t i = 0; i < files.size(); ++i) timed.push_back({times[i], files[i]});
  return timed;
}

// Natural order does not sort decimal fractions, so files are sorted by time.
std::vector<TimedFile> sorted_by_time(std::vector<TimedFile> files) {
  std::ranges::stable_sort(files, {}, &TimedFile::time);
  const auto same = std::ranges::adjacent_find(files, {}, &TimedFile::time);
  if (same == files.end()) return files;
  throw InputError(std::next(same)->path.string(), "has the same time stamp as " + same->path.filename().string(),
                   "remove one of the two");
}

std::optional<std::vector<TimedFile>> timed_by_name(const std::vector<fs::path>& files, const OpenOptions& options) {
  if (options.frame_rate_hz) return std::nullopt;
  const auto times = times_in_names(files);
  if (!times) return std::nullopt;
  return sorted_by_time(with_times(files, *times));
}

std::vector<TimedFile> steadily_timed(const std::vector<fs::path>& files, const OpenOptions& options) {
  return with_times(files, uniform_times(files.size(), options.frame_rate_hz.value_or(kAssumedFrameRate)));
}

void require_equal_count(const std::vector<fs::path>& left, const std::vector<fs::path>& right,
                         const fs::path& folder) {
  if (left.size() == right.size()) return;
  throw InputError(folder.string(),
                   "contains " + std::to_string(left.size()) + " left and " + std::to_string(right.size()) +
                       " right images, and their names do not define pairs",
                   "name the images by their time stamps in nanoseconds, or select one camera");
}

// Left and right images with times from one source.
struct TimedPair {
  std::vector<TimedFile> left, right;
  bool is_rate_guessed = false;
};

TimedPair timed_images(const ImageFolders& folders, const OpenOptions& options, const fs::path& folder) {
  const std::vector<fs::path> left = images_in(folders.left);
  const std::vector<fs::path> right = folders.right ? images_in(*folders.right) : std::vector<fs::path>();
  const auto left_by_name = timed_by_name(left, options);
  const auto right_by_name = timed_by_name(right, options);
  if (left_by_name && (right_by_name || right.empty())) {
    return {*left_by_name, right_by_name.value_or(std::vector<TimedFile>())};
  }
  if (folders.right) require_equal_count(left, right, folder);
  return {steadily_timed(left, options), steadily_timed(right, options), !options.frame_rate_hz};
}

}  // namespace

bool has_images(const fs::path& folder) {
  return folders_of(folder).right || !images_in(folder).empty();
}

RecordingIndex index_images(const fs::path& folder, const OpenOptions& options) {
  ImageFolders folders = folders_of(folder);
  if (options.camera == CameraChoice::left) folders.right.reset();
  const TimedPair images = timed_images(folders, options, folder);
  const Timestamp tolerance = pair_tolerance(options);
  RecordingIndex index{calibration_for(folder, options), frames_of(images.left, images.right, tolerance)};
  if (images.is_rate_guessed) index.warnings.push_back(folder.string() + ": " + kRateWarning);
  if (folders.right) require_pairs(index.frames, images.right, tolerance, folders.right->string());
  return index;
}

}  // namespace byre
