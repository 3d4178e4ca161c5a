#pragma once

#include "byre/features/tag_detector.h"
#include "byre/geometry/tag_pose.h"
#include "byre/image.h"
#include "byre/rig.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

namespace byre {

// 752 x 480 pixels, focal length of EuRoC.
inline Rig rig_of_tags() {
  Rig rig;
  rig.width = 752;
  rig.height = 480;
  rig.focal = 458.0;
  rig.cx = 370.0;
  rig.cy = 245.0;
  return rig;
}

// Upright tag in front of the camera. turn: about the vertical, radians; 0 faces the camera.
inline Pose camera_from_upright_tag(const Eigen::Vector3d& position, double turn) {
  return {rotation_exp({0.0, turn, 0.0}), position};
}

// Image of a tag on a grey wall, with antialiasing and noise of two grey values.
inline Image image_of_tag(const Rig& rig, const Tag& tag, const Pose& camera_from_tag, unsigned seed = 1) {
  constexpr int kSamples = 5;  // per pixel side
  const TagPicture picture = tag_picture(tag.id);
  const double module = tag.size / picture.edge;
  const Pose tag_from_camera = inverse(camera_from_tag);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 2.0);
  Image image{rig.width, rig.height, {}};
  const auto grey_at = [&](const Eigen::Vector2d& pixel) {
    const Eigen::Vector3d direction = tag_from_camera.rotation * rig.ray(pixel);
    const double distance = -tag_from_camera.translation.z() / direction.z();
    const Eigen::Vector3d on_wall = tag_from_camera.translation + distance * direction;
    const double column = std::floor(on_wall.x() / module + 0.5 * picture.modules.width);
    const double row = std::floor(on_wall.y() / module + 0.5 * picture.modules.height);
    const bool is_on_tag =
        distance > 0.0 && column >= 0.0 && row >= 0.0 && column < picture.modules.width && row < picture.modules.height;
    if (!is_on_tag) return 110.0;
    const auto index = static_cast<std::size_t>(row * picture.modules.width + column);
    return picture.modules.pixels[index] > 127 ? 190.0 : 35.0;
  };
  for (int row = 0; row < rig.height; ++row) {
    for (int column = 0; column < rig.width; ++column) {
      double sum = 0.0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const Eigen::Vector2d offset((i % kSamples + 0.5) / kSamples - 0.5, (i / kSamples + 0.5) / kSamples - 0.5);
        sum += grey_at(Eigen::Vector2d(column, row) + offset);
      }
      image.pixels.push_back(
          static_cast<std::uint8_t>(std::clamp(std::lround(sum / (kSamples * kSamples) + noise(random)), 0l, 255l)));
    }
  }
  return image;
}

inline ImageView view_of(const Image& image) {
  return {.data = image.pixels.data(), .width = image.width, .height = image.height};
}

}  // namespace byre
