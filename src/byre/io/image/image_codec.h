#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>

namespace byre {

// OpenCV's decoders and encoders of image files, loaded at first use. Calling OpenCV's functions directly would load
// them at every start of the program. All throw InputError if they cannot be loaded.

// flags: cv::ImreadModes. Empty if the bytes are not an image.
cv::Mat decode_image(const std::vector<std::uint8_t>& bytes, int flags);

// Same for a file; also empty if it is missing.
cv::Mat decode_image_file(const std::filesystem::path& path, int flags);

// extension: ".png", ".jpg"; parameters: cv::ImwriteFlags, each followed by its value.
std::vector<std::uint8_t> encode_image(const char* extension, const cv::Mat& pixels,
                                       const std::vector<int>& parameters = {});

// The extension determines the format. Not synced, see Durability::unsynced. Throws InputError on failure.
void write_image_file(const std::filesystem::path& path, const cv::Mat& pixels,
                      const std::vector<int>& parameters = {});

}  // namespace byre
