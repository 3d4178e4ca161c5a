#pragma once

#include <memory>
#include <string>

#include <opencv2/videoio.hpp>

namespace byre {

// OpenCV's reader and writer of videos by FFmpeg, opened if that is possible; the library is loaded by the first use.
// Only their virtual functions may be called, and neither may be made in any other way: that would have it loaded at
// every start of the program. Both throw InputError where it cannot be loaded.
std::unique_ptr<cv::VideoCapture> open_video_capture(const std::string& file);
// codec: four letters.
std::unique_ptr<cv::VideoWriter> open_video_writer(const std::string& file, const char* codec, double frame_rate_hz,
                                                   const cv::Size& size);

}  // namespace byre
