#pragma once

#include "byre/features/extract.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace byre {

bool has_image_name(const std::filesystem::path& path);

// Image files directly in a folder, in natural order; empty if there is no such folder.
std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder);

// Natural order, with digits compared as numbers: frame9 precedes frame10.
bool natural_less(std::string_view name, std::string_view other);

// Times from file names: nanoseconds ("1403636584763555584.png") or seconds with a decimal point
// ("1305031102.175304.png"). Empty unless all names are times of one kind. Whole numbers with steps below 0.1 ms,
// read as nanoseconds, are frame numbers. Precondition: files are in natural order.
std::optional<std::vector<Timestamp>> times_in_names(const std::vector<std::filesystem::path>& files);

// Time from the name of a single file. Whole numbers count as nanoseconds from 17 digits on, beyond the first years of
// any clock.
std::optional<Timestamp> time_in_name(const std::filesystem::path& file);

// Times at a constant rate, the first one zero. Precondition: frame_rate_hz > 0.
std::vector<Timestamp> uniform_times(std::size_t count, double frame_rate_hz);

// The given files, and the image files directly in the given folders, by name. Throws InputError for missing paths and
// folders without images.
std::vector<std::filesystem::path> find_images(std::span<const std::filesystem::path> files_and_folders);

// Extracts the features of single images of any size.
class ImageDescriber {
 public:
  explicit ImageDescriber(int max_features) { options_.max_features = max_features; }

  // Empty if the file cannot be read as an image.
  std::optional<std::vector<Descriptor>> descriptors_of(const std::filesystem::path& path);

 private:
  Extractor& extractor_for(int width, int height);

  ExtractOptions options_;
  std::map<std::pair<int, int>, Extractor> extractors_;  // key: width and height
};

}  // namespace byre
