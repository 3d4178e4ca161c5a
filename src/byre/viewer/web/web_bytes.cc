#include "byre/viewer/web/web_bytes.h"

#include "byre/input_error.h"
#include "byre/io/image/image_codec.h"
#include "byre/io/image/plan_pixels.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

static_assert(std::endian::native == std::endian::little, "else bytes would have to be swapped");

template <typename Value>
void append(std::string& bytes, Value value) {
  static_assert(std::is_arithmetic_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

void append(std::string& bytes, const Pose& map_from_body) {
  for (const double value : map_from_body.translation) append(bytes, static_cast<float>(value));
  for (const double value : map_from_body.rotation.coeffs()) append(bytes, static_cast<float>(value));
}

std::uint8_t number_of(Origin origin) {
  return origin == Origin::online ? 1 : 0;
}

}  // namespace

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

std::string map_bytes(const MapScene& scene) {
  constexpr std::size_t kBytesPerPoint = 13, kBytesPerKeyframe = 29;
  std::string bytes;
  bytes.reserve(8 + kBytesPerPoint * scene.points.size() + kBytesPerKeyframe * scene.keyframes.size());
  append(bytes, static_cast<std::uint32_t>(scene.points.size()));
  append(bytes, static_cast<std::uint32_t>(scene.keyframes.size()));
  for (const ScenePoint& point : scene.points) {
    for (const float value : point.position_in_map) append(bytes, value);
  }
  for (const SceneKeyframe& keyframe : scene.keyframes) append(bytes, keyframe.map_from_body);
  for (const ScenePoint& point : scene.points) append(bytes, number_of(point.origin));
  for (const SceneKeyframe& keyframe : scene.keyframes) append(bytes, number_of(keyframe.origin));
  return bytes;
}

std::string image_bytes(std::size_t frame, std::span<const SeenPoint> seen, std::span<const unsigned char> jpeg) {
  std::string bytes;
  append(bytes, static_cast<std::uint32_t>(frame));
  append(bytes, static_cast<std::uint32_t>(seen.size()));
  for (const SeenPoint& point : seen) {
    append(bytes, point.pixel.x());
    append(bytes, point.pixel.y());
  }
  for (const SeenPoint& point : seen) {
    append(bytes, static_cast<std::uint8_t>(number_of(point.point.origin) + (point.is_inlier ? 2 : 0)));
  }
  bytes.append(jpeg.begin(), jpeg.end());
  return bytes;
}

}  // namespace byre
