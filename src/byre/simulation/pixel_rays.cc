#include "byre/simulation/pixel_rays.h"

#include <cmath>
#include <limits>

namespace byre {
namespace {

// u of a pixel centre after binning by divisor: the image border at -0.5 stays fixed.
double downscaled_centre(double centre, double divisor) {
  return (centre + 0.5) / divisor - 0.5;
}

Eigen::Vector3f ray_through(const Camera& camera, const Eigen::Vector2d& pixel) {
  const std::optional<Eigen::Vector3d> bearing = camera.bearing(pixel);
  if (!bearing || bearing->z() <= 0.0) return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  return (*bearing / bearing->z()).cast<float>();
}

}  // namespace

Camera downscaled_camera(Camera camera, int divisor) {
  camera.width /= divisor;
  camera.height /= divisor;
  camera.fx /= divisor;
  camera.fy /= divisor;
  camera.cx = downscaled_centre(camera.cx, divisor);
  camera.cy = downscaled_centre(camera.cy, divisor);
  return camera;
}

Camera resized_camera(Camera camera, int width, int height) {
  const double divisor = static_cast<double>(camera.width) / width;
  const double lost = 0.5 * (camera.height / divisor - height);  // rows cut off above, at the new size
  camera.fx /= divisor;
  camera.fy /= divisor;
  camera.cx = downscaled_centre(camera.cx, divisor);
  camera.cy = downscaled_centre(camera.cy, divisor) - lost;
  camera.width = width;
  camera.height = height;
  return camera;
}

PixelRays::PixelRays(const Camera& camera) : width_(camera.width), height_(camera.height) {
  rays_.reserve(static_cast<std::size_t>((width_ + 1) * (height_ + 1)));
  for (int row = 0; row <= height_; ++row) {
    for (int column = 0; column <= width_; ++column) rays_.push_back(ray_through(camera, {column - 0.5, row - 0.5}));
  }
}

std::optional<PixelRays::Corners> PixelRays::corners(int column, int row) const {
  const auto top = static_cast<std::size_t>(row * (width_ + 1) + column);
  const auto bottom = top + static_cast<std::size_t>(width_ + 1);
  const Corners corners{rays_[top], rays_[top + 1], rays_[bottom], rays_[bottom + 1]};
  const float sum = corners.top_left.z() + corners.top_right.z() + corners.bottom_left.z() + corners.bottom_right.z();
  if (std::isnan(sum)) return std::nullopt;
  return corners;
}

}  // namespace byre
