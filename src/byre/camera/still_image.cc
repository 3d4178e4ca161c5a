#include "byre/camera/still_image.h"

#include "byre/io/image/image_codec.h"

#include <cassert>

#include <opencv2/imgcodecs.hpp>

namespace byre {

std::vector<std::uint8_t> png_of(const Image& image) {
  // cv::Mat has no const pixels.
  const cv::Mat pixels(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  constexpr int kFastest = 1;  // noise does not compress, at any effort
  return encode_image(".png", pixels, {cv::IMWRITE_PNG_COMPRESSION, kFastest});
}

Image side_by_side(const Image& left, const Image& right) {
  assert(left.height == right.height);
  Image both{left.width + right.width, left.height, {}};
  both.pixels.reserve(left.pixels.size() + right.pixels.size());
  for (int y = 0; y < left.height; ++y) {
    for (const Image* const image : {&left, &right}) {
      const auto row = image->pixels.begin() + std::ptrdiff_t{y} * image->width;
      both.pixels.insert(both.pixels.end(), row, row + image->width);
    }
  }
  return both;
}

}  // namespace byre
