#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

namespace byre {

// Libraries of OpenCV that are loaded at first use. They depend on decoders and encoders of all kinds (GDAL, FFmpeg,
// two hundred files), which take 50 MB and a tenth of a second. Most runs only read PNG files, which byre decodes
// itself.
enum class OpencvLibrary : std::uint8_t { images, videos };

// Address of a function in that library by its symbol. Throws InputError if the library cannot be loaded or lacks the
// function. Thread-safe.
void* find_function(OpencvLibrary library, const char* symbol);

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

// OpenCV's reader and writer of videos by FFmpeg; the caller checks isOpened(). The library is loaded at first use.
// Call only virtual functions of these objects, and create them only here; anything else would load the library at
// every start of the program. Both throw InputError if the library cannot be loaded.
std::unique_ptr<cv::VideoCapture> open_video_capture(const std::string& file);
// codec: four letters.
std::unique_ptr<cv::VideoWriter> open_video_writer(const std::string& file, const char* codec, double frame_rate_hz,
                                                   const cv::Size& size);

}  // namespace byre
