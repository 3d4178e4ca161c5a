#pragma once

#include "byre/features/extract.h"

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace byre {

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
