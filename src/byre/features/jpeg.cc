#include "byre/features/jpeg.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

namespace byre {
namespace {

// Errors of libjpeg return to a call of setjmp, because it is written in C. Local variables there have no destructors.
struct Errors {
  jpeg_error_mgr manager{};
  std::jmp_buf failed{};
};

jpeg_error_mgr* silent(Errors& errors) {
  jpeg_std_error(&errors.manager);
  errors.manager.error_exit = [](j_common_ptr info) { std::longjmp(reinterpret_cast<Errors*>(info->err)->failed, 1); };
  errors.manager.output_message = [](j_common_ptr) {};
  return &errors.manager;
}

struct Buffer {
  Buffer() = default;
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() { std::free(bytes); }

  unsigned char* bytes = nullptr;  // allocated by libjpeg
  unsigned long size = 0;
};

bool encode(const Image& image, int quality, Buffer& buffer) {
  Errors errors;
  jpeg_compress_struct info;
  info.err = silent(errors);
  jpeg_create_compress(&info);
  if (setjmp(errors.failed) != 0) {
    jpeg_destroy_compress(&info);
    return false;
  }
  jpeg_mem_dest(&info, &buffer.bytes, &buffer.size);
  info.image_width = static_cast<JDIMENSION>(image.width);
  info.image_height = static_cast<JDIMENSION>(image.height);
  info.input_components = 1;
  info.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  info.optimize_coding = TRUE;  // 5 % smaller
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    const std::size_t begin = std::size_t{info.next_scanline} * info.image_width;
    JSAMPROW row = const_cast<JSAMPROW>(image.pixels.data() + begin);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  return true;
}

bool decode(std::span<const std::byte> jpeg, Image& image) {
  constexpr JDIMENSION kMaxSide = 1024;  // pixels
  Errors errors;
  jpeg_decompress_struct info;
  info.err = silent(errors);
  jpeg_create_decompress(&info);
  if (setjmp(errors.failed) != 0) {
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(jpeg.data()), static_cast<unsigned long>(jpeg.size()));
  jpeg_read_header(&info, TRUE);
  bool is_whole = info.image_width <= kMaxSide && info.image_height <= kMaxSide;
  if (is_whole) {
    info.out_color_space = JCS_GRAYSCALE;
    jpeg_start_decompress(&info);
    image.width = static_cast<int>(info.output_width);
    image.height = static_cast<int>(info.output_height);
    image.pixels.resize(std::size_t{info.output_width} * info.output_height);
    while (info.output_scanline < info.output_height) {
      JSAMPROW row = image.pixels.data() + std::size_t{info.output_scanline} * info.output_width;
      jpeg_read_scanlines(&info, &row, 1);
    }
    jpeg_finish_decompress(&info);
    is_whole = errors.manager.num_warnings == 0;  // truncated or damaged data
  }
  jpeg_destroy_decompress(&info);
  return is_whole;
}

}  // namespace

std::vector<std::byte> encode_jpeg(const Image& image, std::size_t max_bytes) {
  if (std::min(image.width, image.height) < 1 || std::max(image.width, image.height) > JPEG_MAX_DIMENSION) return {};
  for (const int quality : {75, 60, 45, 30, 15}) {
    Buffer buffer;
    if (!encode(image, quality, buffer)) return {};
    const std::span jpeg = std::as_bytes(std::span(buffer.bytes, buffer.size));
    if (jpeg.size() <= max_bytes) return {jpeg.begin(), jpeg.end()};
  }
  return {};
}

std::optional<Image> decode_jpeg(std::span<const std::byte> jpeg) {
  Image image;
  if (jpeg.empty() || !decode(jpeg, image)) return std::nullopt;
  return image;
}

}  // namespace byre
