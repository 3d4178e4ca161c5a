// Lens models against OpenCV, and against the formulas that their authors published.

#include "byre/calibration.h"

#include "byre/geometry/geometry_matchers.h"

#include <cmath>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

namespace byre {
namespace {

using testing::Optional;

constexpr double kMaxError = 0.01;  // pixels

using Projector = Eigen::Vector2d (*)(const Camera&, const Eigen::Vector3d&);

std::vector<cv::Point2d> one_point(const Camera& camera, const Eigen::Vector3d& point, bool is_fisheye, int count) {
  const cv::Matx33d matrix(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  const std::vector<cv::Point3d> points = {{point.x(), point.y(), point.z()}};
  const std::vector<double> distortion(camera.distortion.begin(), camera.distortion.begin() + count);
  const cv::Vec3d zero(0.0, 0.0, 0.0);
  std::vector<cv::Point2d> pixels;
  if (is_fisheye) {
    cv::fisheye::projectPoints(points, pixels, zero, zero, matrix, distortion);
  } else {
    cv::projectPoints(points, zero, zero, matrix, distortion, pixels);
  }
  return pixels;
}

Eigen::Vector2d by_opencv(const Camera& camera, const Eigen::Vector3d& point) {
  const cv::Point2d pixel = one_point(camera, point, false, 14).front();
  return {pixel.x, pixel.y};
}

Eigen::Vector2d by_opencv_with_five(const Camera& camera, const Eigen::Vector3d& point) {
  const cv::Point2d pixel = one_point(camera, point, false, 5).front();
  return {pixel.x, pixel.y};
}

Eigen::Vector2d by_opencv_fisheye(const Camera& camera, const Eigen::Vector3d& point) {
  const cv::Point2d pixel = one_point(camera, point, true, 4).front();
  return {pixel.x, pixel.y};
}

Eigen::Vector2d pixel_of(const Camera& camera, double x, double y) {
  return {camera.fx * x + camera.cx, camera.fy * y + camera.cy};
}

// Mei and Rives, Single View Point Omnidirectional Camera Calibration from Planar Grids, ICRA 2007, section II.
Eigen::Vector2d by_mei(const Camera& camera, const Eigen::Vector3d& point) {
  const double k1 = camera.distortion[0], k2 = camera.distortion[1], p1 = camera.distortion[2];
  const double p2 = camera.distortion[3], xi = camera.distortion[4];
  const Eigen::Vector3d sphere = point / point.norm();
  const double x = sphere.x() / (sphere.z() + xi), y = sphere.y() / (sphere.z() + xi);
  const double rho = std::sqrt(x * x + y * y);
  const double radial = k1 * std::pow(rho, 2) + k2 * std::pow(rho, 4);
  return pixel_of(camera, x + x * radial + 2 * p1 * x * y + p2 * (rho * rho + 2 * x * x),
                  y + y * radial + p1 * (rho * rho + 2 * y * y) + 2 * p2 * x * y);
}

// Khomutenko, Garcia, Martinet, An Enhanced Unified Camera Model, RA-L 2016, equation 2.
Eigen::Vector2d by_khomutenko(const Camera& camera, const Eigen::Vector3d& point) {
  const double alpha = camera.distortion[4], beta = camera.distortion[5];
  const double d = std::sqrt(beta * (point.x() * point.x() + point.y() * point.y()) + point.z() * point.z());
  const double depth = alpha * d + (1 - alpha) * point.z();
  return pixel_of(camera, point.x() / depth, point.y() / depth);
}

// Usenko, Demmel, Cremers, The Double Sphere Camera Model, 3DV 2018, equations 40 to 42.
Eigen::Vector2d by_usenko(const Camera& camera, const Eigen::Vector3d& point) {
  const double xi = camera.distortion[4], alpha = camera.distortion[5];
  const double d1 = std::sqrt(point.squaredNorm());
  const double d2 = std::sqrt(point.x() * point.x() + point.y() * point.y() + std::pow(xi * d1 + point.z(), 2));
  const double depth = alpha * d2 + (1 - alpha) * (xi * d1 + point.z());
  return pixel_of(camera, point.x() / depth, point.y() / depth);
}

// Devernay and Faugeras, Straight lines have to be straight, 2001, equation 13.
Eigen::Vector2d by_devernay(const Camera& camera, const Eigen::Vector3d& point) {
  const double omega = camera.distortion[4];
  const double ru = std::hypot(point.x(), point.y()) / point.z();
  const double rd = std::atan(2 * ru * std::tan(omega / 2)) / omega;
  const double direction = std::atan2(point.y(), point.x());
  return pixel_of(camera, rd * std::cos(direction), rd * std::sin(direction));
}

// COLMAP, sensor/models.h, ThinPrismFisheyeCameraModel.
Eigen::Vector2d by_colmap(const Camera& camera, const Eigen::Vector3d& point) {
  const auto& [k1, k2, p1, p2, k3, k4, sx1, sy1, a, b, c, d, e, f] = camera.distortion;
  const double r = std::hypot(point.x(), point.y());
  const double theta = std::atan2(r, point.z());
  const double u = theta * point.x() / r, v = theta * point.y() / r;
  const double r2 = u * u + v * v;
  const double radial = k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2 + k4 * r2 * r2 * r2 * r2;
  return pixel_of(camera, u + u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u) + sx1 * r2,
                  v + v * radial + 2 * p2 * u * v + p1 * (r2 + 2 * v * v) + sy1 * r2);
}

struct Model {
  const char* name;
  Camera camera;
  Projector reference;
  int least_pixels;  // least number of the 768 pixels with a bearing
};

void PrintTo(const Model& model, std::ostream* out) {
  *out << model.name;
}

Camera camera_with(CameraModel model, double focal, const std::array<double, 14>& distortion) {
  return {model, 640, 480, focal, 1.01 * focal, 321.5, 238.5, distortion};
}

class LensModel : public testing::TestWithParam<Model> {};

TEST_P(LensModel, ProjectsAsTheReference) {
  const auto& [name, camera, reference, least_pixels] = GetParam();
  int compared = 0;
  for (int v = 0; v < camera.height; v += 20) {
    for (int u = 0; u < camera.width; u += 20) {
      const Eigen::Vector2d pixel(u, v);
      const auto bearing = camera.bearing(pixel);
      if (!bearing) continue;
      ++compared;
      EXPECT_THAT(reference(camera, 3.0 * *bearing), PointNear(pixel, kMaxError));
      EXPECT_THAT(camera.project(3.0 * *bearing), Optional(PointNear(pixel, 1e-6)));
    }
  }
  EXPECT_GE(compared, least_pixels);
}

TEST_P(LensModel, ProjectsNothingBehindTheCamera) {
  EXPECT_FALSE(GetParam().camera.project({0.1, 0.1, -1.0}));
  EXPECT_FALSE(GetParam().camera.project({0.1, 0.1, 0.0}));
}

INSTANTIATE_TEST_SUITE_P(
    Models, LensModel,
    testing::Values(
        Model{"brown", camera_with(CameraModel::radial_tangential, 458.0, {-0.28, 0.07, 2e-4, 2e-5, 0.01}),
              by_opencv_with_five, 768},
        Model{"equidistant", camera_with(CameraModel::equidistant, 190.0, {0.0034, 0.0007, -0.0020, 0.0002}),
              by_opencv_fisheye, 600},
        Model{
            "rational_8",
            camera_with(CameraModel::rational, 570.0, {-4.53, 15.48, -0.00147, -0.000259, -6.59, -4.60, 15.67, -6.83}),
            by_opencv, 750},
        Model{"rational_12",
              camera_with(CameraModel::rational, 420.0,
                          {0.41, -0.12, 0.0005, -0.0004, 0.003, 0.79, -0.1, 0.002, 0.001, -0.0005, -0.002, 0.0007}),
              by_opencv, 750},
        Model{"rational_14",
              camera_with(CameraModel::rational, 420.0,
                          {0.41, -0.12, 0.0005, -0.0004, 0.003, 0.79, -0.1, 0.002, 0.001, -0.0005, -0.002, 0.0007, 0.03,
                           -0.02}),
              by_opencv, 750},
        Model{"unified", camera_with(CameraModel::unified, 520.0, {-0.17, 0.05, 2e-4, -3e-4, 1.1}), by_mei, 750},
        Model{"extended_unified", camera_with(CameraModel::extended_unified, 230.0, {0, 0, 0, 0, 0.57, 1.12}),
              by_khomutenko, 700},
        Model{"double_sphere", camera_with(CameraModel::double_sphere, 158.0, {0, 0, 0, 0, -0.18, 0.59}), by_usenko,
              550},
        Model{"field_of_view", camera_with(CameraModel::field_of_view, 260.0, {0, 0, 0, 0, 0.93}), by_devernay, 768},
        Model{"thin_prism_fisheye",
              camera_with(CameraModel::thin_prism_fisheye, 300.0,
                          {-0.01, 0.004, 3e-4, -2e-4, -0.002, 0.0003, 0.0008, -0.0011}),
              by_colmap, 700}),
    [](const testing::TestParamInfo<Model>& model) { return std::string(model.param.name); });

TEST(LensModels, HaveNoBearingWhereTheRationalRadiusFolds) {
  // r / (1 + r^2) increases up to r = 1, where it is 0.5.
  const Camera camera = camera_with(CameraModel::rational, 300.0, {0, 0, 0, 0, 0, 1.0});
  EXPECT_TRUE(camera.bearing({camera.cx + 0.49 * camera.fx, camera.cy}));
  EXPECT_FALSE(camera.bearing({camera.cx + 0.51 * camera.fx, camera.cy}));
  EXPECT_TRUE(camera.project({0.99, 0.0, 1.0}));
  EXPECT_FALSE(camera.project({1.01, 0.0, 1.0}));
}

TEST(LensModels, HaveNoBearingBesideThePole) {
  // The denominator 1 - r^2 vanishes at r = 1.
  const Camera camera = camera_with(CameraModel::rational, 300.0, {0, 0, 0, 0, 0, -1.0});
  EXPECT_TRUE(camera.project({0.5, 0.0, 1.0}));
  EXPECT_FALSE(camera.project({1.5, 0.0, 1.0}));
}

}  // namespace
}  // namespace byre
