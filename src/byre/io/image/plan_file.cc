#include "byre/io/image/plan_file.h"

#include "byre/base/output_file.h"

#include <cassert>
#include <cmath>
#include <string>

#include <yaml-cpp/yaml.h>

#include <fmt/format.h>

namespace byre {
namespace {

// Grey values and thresholds of map_server's own writer. Unknown pixels are darker than the free threshold.
constexpr char kFree = '\xfe', kUnknown = '\xcd', kOccupied = '\x00';
constexpr double kOccupiedThreshold = 0.65, kFreeThreshold = 0.196;

char grey_of(std::int8_t occupancy) {
  if (occupancy == kOccupiedPixel) return kOccupied;
  return occupancy == kFreePixel ? kFree : kUnknown;
}

std::string quoted_if_needed(const std::string& text) {
  YAML::Emitter emitter;
  emitter << text;
  return emitter.c_str();
}

}  // namespace

std::filesystem::path plan_description(const std::filesystem::path& image) {
  return std::filesystem::path(image).replace_extension(".yaml");
}

void write_floor_plan(const FloorPlan& plan, std::span<const std::int8_t> occupancy,
                      const std::filesystem::path& image) {
  assert(occupancy.size() == static_cast<std::size_t>(plan.width) * static_cast<std::size_t>(plan.height));
  std::string pixels = fmt::format("P5\n{} {}\n255\n", plan.width, plan.height);
  pixels.reserve(pixels.size() + occupancy.size());
  for (const std::int8_t value : occupancy) pixels += grey_of(value);
  const Eigen::Vector2d right = plan.metres_per_pixel.col(0);
  const Eigen::Vector2d corner = plan.point_at({-0.5, plan.height - 0.5});
  write_atomically(image, pixels);
  write_atomically(plan_description(image),
                   fmt::format("image: {}\nresolution: {}\norigin: [{}, {}, {}]\nnegate: 0\noccupied_thresh: {}\n"
                               "free_thresh: {}\nmode: trinary\n",
                               quoted_if_needed(image.filename().string()), right.norm(), corner.x(), corner.y(),
                               std::atan2(right.y(), right.x()), kOccupiedThreshold, kFreeThreshold));
}

}  // namespace byre
