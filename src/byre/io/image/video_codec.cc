#include "byre/io/image/video_codec.h"

#include "byre/io/image/opencv_library.h"

#include <new>

namespace byre {
namespace {

// Calls the constructor with this symbol and exactly these argument types. The destructor is virtual, so the library's
// own is called.
template <typename Class, typename... Arguments>
std::unique_ptr<Class> constructed(const char* constructor, Arguments... arguments) {
  using Construct = void(void*, Arguments...);
  auto* const construct = reinterpret_cast<Construct*>(find_function(OpencvLibrary::videos, constructor));
  void* const memory = ::operator new(sizeof(Class));
  construct(memory, arguments...);
  return std::unique_ptr<Class>(static_cast<Class*>(memory));
}

}  // namespace

std::unique_ptr<cv::VideoCapture> open_video_capture(const std::string& file) {
  return constructed<cv::VideoCapture, const std::string&, int>(
      "_ZN2cv12VideoCaptureC1ERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEEi", file, cv::CAP_FFMPEG);
}

std::unique_ptr<cv::VideoWriter> open_video_writer(const std::string& file, const char* codec, double frame_rate_hz,
                                                   const cv::Size& size) {
  const int fourcc = codec[0] | codec[1] << 8 | codec[2] << 16 | codec[3] << 24;
  return constructed<cv::VideoWriter, const std::string&, int, int, double, cv::Size, bool>(
      "_ZN2cv11VideoWriterC1ERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEEiidNS_5Size_IiEEb", file,
      cv::CAP_FFMPEG, fourcc, frame_rate_hz, size, true);
}

}  // namespace byre
