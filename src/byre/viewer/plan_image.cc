#include "byre/viewer/plan_image.h"

#include "byre/input_error.h"
#include "byre/io/image/image_codec.h"
#include "byre/io/image/plan_pixels.h"

#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace byre {

std::string plan_png(const FloorPlan& plan, int max_side) {
  cv::Mat image = render_plan(plan);
  if (image.empty()) throw InputError(plan.image.string(), "is not a readable image", "give a PNG, JPEG or PGM");
  const int longest = std::max(image.cols, image.rows);
  if (longest > max_side) {
    const double scale = static_cast<double>(max_side) / longest;
    cv::resize(image, image, {}, scale, scale, cv::INTER_AREA);
  }
  const std::vector<std::uint8_t> png = encode_image(".png", image);
  return {png.begin(), png.end()};
}

}  // namespace byre
