#pragma once

// Two views of synthetic points with a given motion, for tests of two-view estimators.

#include "byre/geometry/two_view_match.h"
#include "byre/rig.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace byre {

struct TwoViewSceneOptions {
  int count = 300;
  double pixel_sigma = 0.0;    // noise in each view, pixels
  double outlier_ratio = 0.0;  // share of matches whose second pixel is displaced by up to 60 pixels per axis
  std::uint32_t seed = 1;
};

inline Rig one_camera() {
  return {
      .width = 752, .height = 480, .focal = 450.0, .cx = 376.0, .cy = 240.0, .baseline = 0.0, .body_from_camera = {}};
}

// Sideways and a little forward, with a rotation.
inline Pose sideways_motion(double metres) {
  return {rotation_exp({0.02, -0.05, 0.03}), metres * Eigen::Vector3d(0.9, 0.1, -0.4).normalized()};
}

// Depth of the scene along a ray of the first camera; random is uniform between 0 and 1.
using DepthOf = std::function<double(const Eigen::Vector3d& ray, double random)>;

inline double room_depth(const Eigen::Vector3d&, double random) {
  return 2.0 + 6.0 * random;
}

// The plane z + 0.4 x + 0.2 y = 4.
inline double wall_depth(const Eigen::Vector3d& ray, double) {
  return 4.0 / (1.0 + 0.4 * ray.x() + 0.2 * ray.y());
}

// Matches of points in view of both cameras, with noisy pixels; sigma is that of the noise, or 1 pixel without noise.
inline std::vector<TwoViewMatch> matches_of(const Pose& second_from_first, const DepthOf& depth_of,
                                            const TwoViewSceneOptions& options) {
  const Rig rig = one_camera();
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> column(0.0, rig.width - 1.0), row(0.0, rig.height - 1.0), unit(0.0, 1.0);
  std::uniform_real_distribution<double> anywhere(-60.0, 60.0);
  std::normal_distribution<double> normal;
  const auto noisy = [&](const Eigen::Vector2d& pixel, double sigma) -> Eigen::Vector2d {
    const double du = normal(random), dv = normal(random);
    return pixel + sigma * Eigen::Vector2d(du, dv);
  };
  std::vector<TwoViewMatch> matches;
  while (static_cast<int>(matches.size()) < options.count) {
    const double u = column(random), v = row(random);
    const Eigen::Vector3d ray = rig.ray({u, v});
    const Eigen::Vector3d in_second = second_from_first * (depth_of(ray, unit(random)) * ray);
    if (in_second.z() < 0.1 || !rig.contains(rig.project(in_second).head<2>())) continue;
    Eigen::Vector2d second = noisy(rig.project(in_second).head<2>(), options.pixel_sigma);
    const double du = anywhere(random), dv = anywhere(random);
    if (unit(random) < options.outlier_ratio) second += Eigen::Vector2d(du, dv);
    const double sigma = (options.pixel_sigma > 0.0 ? options.pixel_sigma : 1.0) / rig.focal;
    matches.push_back({rig.ray(noisy({u, v}, options.pixel_sigma)), rig.ray(second), sigma});
  }
  return matches;
}

// Radians between the directions of two translations.
inline double angle_between_translations(const Pose& first, const Pose& second) {
  return std::atan2(first.translation.cross(second.translation).norm(), first.translation.dot(second.translation));
}

}  // namespace byre
