#include "byre/io/image/image_codec.h"

#include "byre/base/output_file.h"
#include "byre/input_error.h"
#include "byre/io/image/opencv_library.h"

#include <fstream>
#include <iterator>
#include <span>
#include <string>

namespace byre {

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

}  // namespace byre
