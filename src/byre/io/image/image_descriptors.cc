#include "byre/io/image/image_descriptors.h"

#include "byre/input_error.h"
#include "byre/io/image/image_file.h"
#include "byre/io/image/image_names.h"

#include <algorithm>

namespace byre {
namespace {

namespace fs = std::filesystem;

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
