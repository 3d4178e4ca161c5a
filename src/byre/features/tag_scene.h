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
  struct Place {  // on the wall; column and row of a module, outside the picture -1 or its width or height
    int column;
    int row;
    bool is_seen;  // in front of the camera
    bool operator==(const Place&) const = default;
  };
  const auto place_at = [&](double x, double y) -> Place {
    const Eigen::Vector3d direction = tag_from_camera.rotation * rig.ray(Eigen::Vector2d(x, y));
    const double distance = -tag_from_camera.translation.z() / direction.z();
    const Eigen::Vector3d on_wall = tag_from_camera.translation + distance * direction;
    const auto module_of = [&](double metres, int modules) {
      return static_cast<int>(std::clamp(std::floor(metres / module + 0.5 * modules), -1.0, 1.0 * modules));
    };
    return {module_of(on_wall.x(), picture.modules.width), module_of(on_wall.y(), picture.modules.height),
            distance > 0.0};
  };
  const auto grey_of = [&](const Place& place) {
    const auto& [width, height, pixels] = picture.modules;
    const auto [column, row, is_seen] = place;
    if (!is_seen || column < 0 || row < 0 || column >= width || row >= height) return 110.0;
    return pixels[static_cast<std::size_t>(row * width + column)] > 127 ? 190.0 : 35.0;
  };
  const auto mean_grey = [&](int column, int row) {
    const Place corner = place_at(column - 0.5, row - 0.5);
    const bool is_even = corner == place_at(column + 0.5, row - 0.5) && corner == place_at(column - 0.5, row + 0.5) &&
                         corner == place_at(column + 0.5, row + 0.5);
    if (is_even) return grey_of(corner);
    double sum = 0.0;
    for (int i = 0; i < kSamples * kSamples; ++i) {
      const double x = column + ((i % kSamples + 0.5) / kSamples - 0.5);
      const double y = row + ((i / kSamples + 0.5) / kSamples - 0.5);
      sum += grey_of(place_at(x, y));
    }
    return sum / (kSamples * kSamples);
  };
  for (int row = 0; row < rig.height; ++row) {
    for (int column = 0; column < rig.width; ++column) {
      const double grey = mean_grey(column, row) + noise(random);
      image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0l, 255l)));
    }
  }
  return image;
}

inline ImageView view_of(const Image& image) {
  return {.data = image.pixels.data(), .width = image.width, .height = image.height};
}

}  // namespace byre
