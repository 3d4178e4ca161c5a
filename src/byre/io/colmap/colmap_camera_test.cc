#include "byre/io/colmap/colmap_camera.h"

#include "byre/io/recording/folder_scene.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

constexpr double kFocal = 400.0;

// Projection of a point at (0.3, -0.2, 1), in COLMAP's pixels.
Eigen::Vector2d pixel_in(const std::string& model, const std::vector<double>& parameters) {
  const Camera camera = camera_of({model, 640, 480, parameters}, "camera");
  return to_colmap_pixel(camera.project({0.3, -0.2, 1.0}).value());
}

constexpr double kSquaredRadius = 0.3 * 0.3 + 0.2 * 0.2;

Eigen::Vector2d scaled(double radial) {
  return {320.0 + kFocal * 0.3 * radial, 240.0 - kFocal * 0.2 * radial};
}

void expect_near(const Eigen::Vector2d& pixel, const Eigen::Vector2d& expected) {
  EXPECT_NEAR(pixel.x(), expected.x(), 1e-9);
  EXPECT_NEAR(pixel.y(), expected.y(), 1e-9);
}

TEST(CameraOf, ProjectsLikeColmap) {
  expect_near(pixel_in("SIMPLE_PINHOLE", {kFocal, 320, 240}), scaled(1.0));
  expect_near(pixel_in("PINHOLE", {kFocal, kFocal, 320, 240}), scaled(1.0));
  const double first = 1.0 + 0.1 * kSquaredRadius;
  const double both = first - 0.05 * kSquaredRadius * kSquaredRadius;
  expect_near(pixel_in("SIMPLE_RADIAL", {kFocal, 320, 240, 0.1}), scaled(first));
  expect_near(pixel_in("RADIAL", {kFocal, 320, 240, 0.1, -0.05}), scaled(both));
  const double p1 = 1e-3, p2 = -2e-3, u = 0.3, v = -0.2;
  const Eigen::Vector2d tangential(2.0 * p1 * u * v + p2 * (kSquaredRadius + 2.0 * u * u),
                                   2.0 * p2 * u * v + p1 * (kSquaredRadius + 2.0 * v * v));
  expect_near(pixel_in("OPENCV", {kFocal, kFocal, 320, 240, 0.1, -0.05, p1, p2}), scaled(both) + kFocal * tangential);
  const double radius = std::sqrt(kSquaredRadius), theta = std::atan(radius);
  expect_near(pixel_in("OPENCV_FISHEYE", {kFocal, kFocal, 320, 240, 0.1, -0.05, 0, 0}),
              scaled((theta + 0.1 * std::pow(theta, 3) - 0.05 * std::pow(theta, 5)) / radius));
  expect_near(pixel_in("SIMPLE_RADIAL_FISHEYE", {kFocal, 320, 240, 0.1}),
              scaled((theta + 0.1 * std::pow(theta, 3)) / radius));
  expect_near(pixel_in("RADIAL_FISHEYE", {kFocal, 320, 240, 0.1, -0.05}),
              scaled((theta + 0.1 * std::pow(theta, 3) - 0.05 * std::pow(theta, 5)) / radius));
  expect_near(pixel_in("FOV", {kFocal, kFocal, 320, 240, 0.9}),
              scaled(std::atan(2.0 * radius * std::tan(0.45)) / (0.9 * radius)));
  expect_near(pixel_in("FULL_OPENCV", {kFocal, kFocal, 320, 240, 0.1, -0.05, 0, 0, 0, 0.2, 0, 0}),
              scaled(both / (1.0 + 0.2 * kSquaredRadius)));
  const double squared_theta = theta * theta;
  const Eigen::Vector2d prism(0.002 * squared_theta, -0.001 * squared_theta);
  expect_near(pixel_in("THIN_PRISM_FISHEYE", {kFocal, kFocal, 320, 240, 0.1, 0, 0, 0, 0, 0, 0.002, -0.001}),
              scaled((theta + 0.1 * std::pow(theta, 3)) / radius) + kFocal * prism);
}

TEST(CameraOf, RejectsUnsupportedModels) {
  const auto error = [](const std::string& model, const std::vector<double>& parameters) {
    return error_of([&] { camera_of({model, 640, 480, parameters}, "camera 3"); });
  };
  EXPECT_THAT(error("FOV", {400, 400, 320, 240, 4}), HasSubstr("camera 3: has shape parameters outside 0 < omega"));
  EXPECT_THAT(error("PINHOLE", {0, 400, 320, 240}), HasSubstr("focal"));
  EXPECT_THAT(error("PINHOLE", {400, 400, 700, 240}), HasSubstr("principal point"));
  EXPECT_THAT(error("PINHOLE", {400, 400, 320}), HasSubstr("number of parameters"));
  EXPECT_THAT(error_of([] {
                camera_of({"SIMPLE_PINHOLE", 1u << 31, 480, {1, 1, 1}}, "camera 3");
              }),
              HasSubstr("width or height"));
}

TEST(ColmapCamera, ConvertsBackToTheSameCamera) {
  const Camera pinhole{CameraModel::pinhole, 640, 480, 400.5, 399.5, 320.25, 239.75, {}};
  Camera lens = pinhole, long_lens = pinhole, fisheye = pinhole;
  lens.model = long_lens.model = CameraModel::radial_tangential;
  fisheye.model = CameraModel::equidistant;
  lens.distortion = {-0.28, 0.07, 1e-4, 2e-5, 0.0};
  long_lens.distortion = {-0.28, 0.07, 1e-4, 2e-5, 0.01};
  fisheye.distortion = {0.01, 0.02, 0.03, 0.04, 0.0};
  Camera rational = pinhole, prism = pinhole;
  rational.model = CameraModel::rational;
  rational.distortion = {-0.28, 0.07, 1e-4, 2e-5, 0.01, 0.1, 0.2, 0.3};
  prism.model = CameraModel::thin_prism_fisheye;
  prism.distortion = {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.001, 0.002};
  for (const Camera& camera : {pinhole, lens, long_lens, fisheye, rational, prism}) {
    const ColmapCamera exported = colmap_camera(camera);
    SCOPED_TRACE(exported.model);
    const Camera again = camera_of(exported, "camera");
    EXPECT_EQ(again.model, camera.model);
    EXPECT_EQ(again.width, camera.width);
    EXPECT_EQ(again.height, camera.height);
    EXPECT_EQ(again.fx, camera.fx);
    EXPECT_EQ(again.fy, camera.fy);
    EXPECT_EQ(again.cx, camera.cx);
    EXPECT_EQ(again.cy, camera.cy);
    EXPECT_EQ(again.distortion, camera.distortion);
  }
  Camera sphere = pinhole;
  sphere.model = CameraModel::double_sphere;
  EXPECT_THAT(error_of([&] { colmap_camera(sphere); }), HasSubstr("COLMAP has no camera model for double_sphere"));
}

}  // namespace
}  // namespace byre
