#include "byre/io/image/image_names.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/image/image_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace byre {
namespace {

namespace fs = std::filesystem;

bool is_digit(char character) {
  return std::isdigit(static_cast<unsigned char>(character)) != 0;
}

// Removes the digits at the start of a name, and returns them without leading zeros.
std::string_view take_number(std::string_view& name) {
  const std::string_view digits(name.begin(), std::ranges::find_if_not(name, is_digit));
  name.remove_prefix(digits.size());
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

std::optional<Timestamp> seconds_in_name(const fs::path& file) {
  const std::string stem = file.stem().string();
  const bool is_decimal = std::ranges::all_of(stem, [](char c) { return is_digit(c) || c == '.'; });
  if (!is_decimal || stem.find('.') == std::string::npos) return std::nullopt;
  return parse_seconds(stem);
}

std::optional<Timestamp> nanoseconds_in_name(const fs::path& file) {
  const std::string stem = file.stem().string();
  return std::ranges::all_of(stem, is_digit) ? parse_nanoseconds(stem) : std::nullopt;
}

template <typename TimeOf>
std::optional<std::vector<Timestamp>> times_of_all(const std::vector<fs::path>& files, TimeOf time_of) {
  std::vector<Timestamp> times;
  for (const fs::path& file : files) {
    const std::optional<Timestamp> time = time_of(file);
    if (!time) return std::nullopt;
    times.push_back(*time);
  }
  return times;
}

std::vector<fs::path> images_by_name(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && has_image_name(entry.path())) images.push_back(entry.path());
  }
  if (images.empty()) throw InputError(folder.string(), "contains no images", "give the folder of the images");
  std::ranges::sort(images);
  return images;
}

// An ideal camera with a field of view of 53 degrees; descriptors do not depend on it.
Calibration ideal_calibration(int width, int height) {
  Calibration calibration;
  Camera& camera = calibration.left;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = width;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return calibration;
}

}  // namespace

bool has_image_name(const fs::path& path) {
  constexpr std::array<std::string_view, 8> kExtensions = {".png", ".jpg", ".jpeg", ".bmp",
                                                           ".pgm", ".ppm", ".tif",  ".tiff"};
  return std::ranges::find(kExtensions, lower_case(path.extension().string())) != kExtensions.end();
}

std::vector<fs::path> images_in(const fs::path& folder) {
  std::vector<fs::path> images;
  if (!fs::is_directory(folder)) return images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && has_image_name(entry.path())) images.push_back(entry.path());
  }
  std::ranges::sort(images, [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return images;
}

bool natural_less(std::string_view name, std::string_view other) {
  const std::string_view whole_name = name, whole_other = other;
  while (!name.empty() && !other.empty()) {
    if (is_digit(name.front()) && is_digit(other.front())) {
      const std::string_view number = take_number(name), other_number = take_number(other);
      if (number.size() != other_number.size()) return number.size() < other_number.size();
      if (number != other_number) return number < other_number;
      continue;
    }
    if (name.front() != other.front()) return name.front() < other.front();
    name.remove_prefix(1);
    other.remove_prefix(1);
  }
  if (name.empty() && other.empty()) return whole_name < whole_other;  // equal except for leading zeros
  return name.empty();
}

std::optional<std::vector<Timestamp>> times_in_names(const std::vector<fs::path>& files) {
  if (files.size() < 2) return std::nullopt;
  if (auto seconds = times_of_all(files, seconds_in_name)) return seconds;
  auto nanoseconds = times_of_all(files, nanoseconds_in_name);
  constexpr Timestamp kLeastStep = std::chrono::microseconds(100);
  if (!nanoseconds) return std::nullopt;
  const Timestamp span = nanoseconds->back() - nanoseconds->front();
  const bool are_times = span >= kLeastStep * static_cast<Timestamp::rep>(files.size() - 1);
  return are_times ? nanoseconds : std::nullopt;
}

std::optional<Timestamp> time_in_name(const fs::path& file) {
  constexpr Timestamp kFirstYears{100'000'000'000'000'000};
  if (const auto seconds = seconds_in_name(file)) return seconds;
  const std::optional<Timestamp> nanoseconds = nanoseconds_in_name(file);
  return nanoseconds && *nanoseconds >= kFirstYears ? nanoseconds : std::nullopt;
}

std::vector<Timestamp> uniform_times(std::size_t count, double frame_rate_hz) {
  std::vector<Timestamp> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(from_seconds(static_cast<double>(i) / frame_rate_hz));
  return times;
}

std::vector<fs::path> find_images(std::span<const fs::path> files_and_folders) {
  std::vector<fs::path> images;
  for (const fs::path& path : files_and_folders) {
    if (!fs::exists(path)) throw InputError(path.string(), "does not exist", "give images or folders of images");
    if (!fs::is_directory(path)) {
      images.push_back(path);
      continue;
    }
    const std::vector<fs::path> found = images_by_name(path);
    images.insert(images.end(), found.begin(), found.end());
  }
  return images;
}

Extractor& ImageDescriber::extractor_for(int width, int height) {
  const auto found = extractors_.find({width, height});
  if (found != extractors_.end()) return found->second;
  return extractors_.emplace(std::pair(width, height), Extractor(ideal_calibration(width, height), options_))
      .first->second;
}

std::optional<std::vector<Descriptor>> ImageDescriber::descriptors_of(const fs::path& path) {
  std::optional<Image> image = read_image(path);
  if (!image) return std::nullopt;
  Extractor& extractor = extractor_for(image->width, image->height);
  return to_vector(extractor.extract({{}, std::move(*image), {}}).frame.features->descriptors());
}

}  // namespace byre
