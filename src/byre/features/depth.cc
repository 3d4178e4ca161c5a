#include "byre/features/depth.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>

namespace byre {
namespace {

constexpr int kSearchRadius = 2;   // pixels, half the side of the square sampled around a corner
constexpr double kMinShare = 0.4;  // least share of that square on one surface
constexpr double kMaxGap = 0.03;   // largest depth step between samples of one surface, relative to the depth

// A depth near a keypoint.
struct Sample {
  float depth = 0.0f;                 // metres
  Eigen::Vector2d offset_of_pixel{};  // from the keypoint to the pixel, pixels
};

// Plane with an inverse depth that is linear in the image (pixels of the original left image).
struct Surface {
  double inverse_depth = 0.0;  // inverse depth at the keypoint, per metre
  Eigen::Vector2d slope;       // change of the inverse depth per pixel
  double residual = 0.0;       // root mean square, per metre
};

// All depths in the square around the pixel, nearest first.
std::vector<Sample> samples_around(const Eigen::Vector2d& pixel, const std::vector<float>& depths,
                                   const Camera& camera) {
  const int column = static_cast<int>(std::lround(pixel.x()));
  const int row = static_cast<int>(std::lround(pixel.y()));
  std::vector<Sample> samples;
  for (int v = std::max(0, row - kSearchRadius); v <= std::min(camera.height - 1, row + kSearchRadius); ++v) {
    for (int u = std::max(0, column - kSearchRadius); u <= std::min(camera.width - 1, column + kSearchRadius); ++u) {
      const float depth =
          depths[static_cast<std::size_t>(v) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(u)];
      if (depth > 0.0f) samples.push_back({depth, Eigen::Vector2d(u, v) - pixel});
    }
  }
  std::ranges::sort(samples, {}, &Sample::depth);
  return samples;
}

// Samples up to the first gap. Precondition: sorted by depth.
std::span<const Sample> nearest_surface(const std::vector<Sample>& samples) {
  const auto is_gap = [&](const Sample& near, const Sample& far) {
    return far.depth - near.depth > kMaxGap * near.depth;
  };
  const auto last = std::ranges::adjacent_find(samples, is_gap);
  const auto count = last == samples.end() ? samples.size() : static_cast<std::size_t>(last - samples.begin()) + 1;
  return std::span(samples).first(count);
}

Surface fit_surface(std::span<const Sample> samples) {
  constexpr double kRidge = 1e-6;  // keeps the system regular if all samples are in one row
  Eigen::Matrix3d normal_matrix = kRidge * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples) {
    const Eigen::Vector3d terms(1.0, sample.offset_of_pixel.x(), sample.offset_of_pixel.y());
    normal_matrix += terms * terms.transpose();
    right_side += terms / sample.depth;
  }
  const Eigen::Vector3d solution = normal_matrix.ldlt().solve(right_side);
  double squares = 0.0;
  for (const Sample& sample : samples) {
    const double fitted = solution[0] + solution.tail<2>().dot(sample.offset_of_pixel);
    squares += std::pow(fitted - 1.0 / sample.depth, 2);
  }
  return {solution[0], solution.tail<2>(), std::sqrt(squares / static_cast<double>(samples.size()))};
}

}  // namespace

DepthReader::DepthReader(const Calibration& calibration, const Rig& rig)
    : left_(calibration.left), depth_camera_(calibration.depth.value()), rig_(rig) {
  if (!depth_camera_.camera) return;
  const Camera& camera = *depth_camera_.camera;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto bearing = camera.bearing({u, v});
      const bool is_forward = bearing && bearing->z() > 0.0;
      rays_.push_back(is_forward ? Eigen::Vector3d(*bearing / bearing->z()) : Eigen::Vector3d::Zero());
    }
  }
}

std::vector<float> DepthReader::depths_in_left(const DepthImage& image) const {
  if (depth_camera_.camera) return warped_to_left(image);
  const auto metres_per_unit = static_cast<float>(1.0 / depth_camera_.units_per_metre);
  std::vector<float> depths(image.units.size());
  std::ranges::transform(image.units, depths.begin(),
                         [=](std::uint16_t units) { return metres_per_unit * static_cast<float>(units); });
  return depths;
}

// Projects each depth to the left image, and spreads it over as many pixels as avoid holes between neighbours. The
// nearest depth wins.
std::vector<float> DepthReader::warped_to_left(const DepthImage& image) const {
  const int spread = static_cast<int>(std::ceil(left_.fx / depth_camera_.camera->fx)) - 1;
  std::vector<float> depths(static_cast<std::size_t>(left_.width) * static_cast<std::size_t>(left_.height), 0.0f);
  for (std::size_t i = 0; i < image.units.size(); ++i) {
    if (image.units[i] == 0 || rays_[i].z() == 0.0) continue;
    const double depth = image.units[i] / depth_camera_.units_per_metre;
    const Eigen::Vector3d point_in_left = depth_camera_.left_from_depth * (depth * rays_[i]);
    const auto pixel = point_in_left.z() > 0.0 ? left_.project(point_in_left) : std::nullopt;
    if (!pixel || !left_.contains(*pixel)) continue;
    const auto column = static_cast<int>(std::lround(pixel->x())), row = static_cast<int>(std::lround(pixel->y()));
    for (int v = std::max(0, row - spread / 2); v <= std::min(left_.height - 1, row + (spread + 1) / 2); ++v) {
      for (int u = std::max(0, column - spread / 2); u <= std::min(left_.width - 1, column + (spread + 1) / 2); ++u) {
        float& nearest =
            depths[static_cast<std::size_t>(v) * static_cast<std::size_t>(left_.width) + static_cast<std::size_t>(u)];
        const auto z = static_cast<float>(point_in_left.z());
        if (nearest == 0.0f || z < nearest) nearest = z;
      }
    }
  }
  return depths;
}

std::vector<std::optional<DepthReading>> DepthReader::read(const DepthImage& image,
                                                           const std::vector<Keypoint>& keypoints,
                                                           const DepthOptions& options) const {
  const std::vector<float> depths = depths_in_left(image);
  const double pixels_per_inverse_depth = rig_.focal * rig_.baseline;
  const int side = 2 * kSearchRadius + 1;
  const double min_samples = std::max(3.0, kMinShare * side * side);
  const auto read_one = [&](const Keypoint& keypoint) -> std::optional<DepthReading> {
    const auto pixel = left_.project(rig_.ray(keypoint.pixel.cast<double>()));
    if (!pixel || !left_.contains(*pixel)) return std::nullopt;
    const std::vector<Sample> samples = samples_around(*pixel, depths, left_);
    const std::span<const Sample> nearest = nearest_surface(samples);
    if (static_cast<double>(nearest.size()) < min_samples) return std::nullopt;
    const Surface surface = fit_surface(nearest);
    if (!(surface.inverse_depth * options.max_depth > 1.0)) return std::nullopt;
    const double sigma = pixels_per_inverse_depth * std::hypot(depth_camera_.sigma_at_one_metre, surface.residual,
                                                               options.misalignment * surface.slope.norm());
    return DepthReading{static_cast<float>(pixels_per_inverse_depth * surface.inverse_depth),
                        static_cast<float>(sigma)};
  };
  std::vector<std::optional<DepthReading>> readings;
  readings.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) readings.push_back(read_one(keypoint));
  return readings;
}

}  // namespace byre
