#pragma once

#include <memory>
#include <string>

#include <opencv2/videoio.hpp>

namespace byre {

// OpenCV's reader and writer of videos by FFmpeg; the caller checks isOpened(). The library is loaded at first use.
// Call only virtual functions of these objects, and create them only here; anything else would load the library at
// every start of the program. Both throw InputError if the library cannot be loaded.
std::unique_ptr<cv::VideoCapture> open_video_capture(const std::string& file);
// codec: four letters.
std::unique_ptr<cv::VideoWriter> open_video_writer(const std::string& file, const char* codec, double frame_rate_hz,
                                                   const cv::Size& size);

}  // namespace byre
