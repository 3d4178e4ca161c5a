#include "byre/io/image/image_fit.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace byre {

Image resize_to_cover(const Image& image, int width, int height) {
  const cv::Mat source(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  const double scale = std::max(static_cast<double>(width) / image.width, static_cast<double>(height) / image.height);
  const cv::Size covering(std::max(width, static_cast<int>(std::lround(image.width * scale))),
                          std::max(height, static_cast<int>(std::lround(image.height * scale))));
  cv::Mat scaled;
  cv::resize(source, scaled, covering, 0.0, 0.0, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);

  Image result{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height)};
  const cv::Rect middle((covering.width - width) / 2, (covering.height - height) / 2, width, height);
  scaled(middle).copyTo(cv::Mat(height, width, CV_8U, result.pixels.data()));
  return result;
}

}  // namespace byre
