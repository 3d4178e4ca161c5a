#include "byre/io/image/image_codec.h"

#include "byre/base/output_file.h"
#include "byre/input_error.h"

#include <fstream>
#include <iterator>
#include <new>
#include <span>

#include <dlfcn.h>

namespace byre {
namespace {

std::string reason_of_failure() {
  const char* const reason = dlerror();
  return reason ? std::string("cannot be used: ") + reason : "cannot be used";
}

InputError unusable(const char* name) {
  return {name, reason_of_failure(), "install this OpenCV module in the version used to build byre"};
}

// The library stays loaded.
void* load(const char* name) {
  void* const library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) throw unusable(name);
  return library;
}

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

void* find_function(OpencvLibrary library, const char* symbol) {
  const char* const name = library == OpencvLibrary::images ? BYRE_OPENCV_IMAGES : BYRE_OPENCV_VIDEOS;
  void* const function = dlsym(load(name), symbol);
  if (function == nullptr) throw unusable(name);
  return function;
}

cv::Mat decode_image(const std::vector<std::uint8_t>& bytes, int flags) {
  using Decode = cv::Mat(const cv::_InputArray&, int);  // cv::imdecode
  static auto* const decode =
      reinterpret_cast<Decode*>(find_function(OpencvLibrary::images, "_ZN2cv8imdecodeERKNS_11_InputArrayEi"));
  return decode(bytes, flags);
}

cv::Mat decode_image_file(const std::filesystem::path& path, int flags) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  return bytes.empty() ? cv::Mat() : decode_image(bytes, flags);
}

std::vector<std::uint8_t> encode_image(const char* extension, const cv::Mat& pixels,
                                       const std::vector<int>& parameters) {
  using Encode = bool(const std::string&, const cv::_InputArray&, std::vector<std::uint8_t>&,
                      const std::vector<int>&);  // cv::imencode
  static auto* const encode =
      reinterpret_cast<Encode*>(find_function(OpencvLibrary::images,
                                              "_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
                                              "RKNS_11_InputArrayERSt6vectorIhSaIhEERKSB_IiSaIiEE"));
  std::vector<std::uint8_t> bytes;
  if (!encode(extension, pixels, bytes, parameters)) {
    throw InputError("image", std::string("cannot be encoded as ") + extension,
                     "choose a name that ends in .png or .jpg");
  }
  return bytes;
}

void write_image_file(const std::filesystem::path& path, const cv::Mat& pixels, const std::vector<int>& parameters) {
  const std::vector<std::uint8_t> bytes = encode_image(path.extension().c_str(), pixels, parameters);
  write_atomically(path, std::as_bytes(std::span(bytes)), Durability::unsynced);
}

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
