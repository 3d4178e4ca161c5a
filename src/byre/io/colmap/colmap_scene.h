#pragma once

// A small COLMAP model for tests of its files.

#include "byre/io/colmap/colmap_model.h"

namespace byre {

// Two cameras, three images of which one has no keypoints, two points. All numbers need many digits.
inline ColmapModel small_colmap_model() {
  ColmapModel model;
  model.cameras[1] = {"OPENCV", 752, 480, {458.654, 457.296, 367.715, 248.875, -0.28340811, 0.07395907, 1.9e-4, 1e-5}};
  model.cameras[7] = {"SIMPLE_RADIAL", 640, 480, {500.0 / 3.0, 320.0, 240.0, 0.1}};
  const Eigen::Quaterniond turned = Eigen::Quaterniond(0.9, 0.1, -0.3, 0.2).normalized();
  model.images[2] = {"a/1403.png",
                     1,
                     {turned, {0.1, 1.0 / 3.0, -1e-17}},
                     {{{100.25, 200.0 / 7.0}, 5}, {{1e-3, 479.5}, {}}, {{300.0, 20.5}, 9}}};
  model.images[3] = {"b.jpg", 7, {turned.conjugate(), {-1e6, 0.0, 2.0}}, {{{10.0, 10.0}, 9}, {{12.0, 10.0}, 5}}};
  model.images[8] = {"empty.jpg", 7, {}, {}};
  model.points[5] = {{0.1, -2.0 / 3.0, 1e12}, {255, 0, 17}, 1.0 / 3.0, {{2, 0}, {3, 1}}};
  model.points[9] = {{1.0, 2.0, 3.0}, {}, -1.0, {{2, 2}, {3, 0}}};
  return model;
}

}  // namespace byre
