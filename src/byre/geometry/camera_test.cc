#include "byre/calibration.h"

#include "byre/geometry/geometry_matchers.h"

#include <cmath>
#include <numbers>
#include <ostream>

#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::Eq;
using testing::Optional;

Camera pinhole() {
  return {CameraModel::pinhole, 640, 480, 400.0, 410.0, 320.0, 240.0, {}};
}

// EuRoC, cam0.
Camera radial_tangential() {
  return {CameraModel::radial_tangential,
          752,
          480,
          458.654,
          457.296,
          367.215,
          248.375,
          {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
}

// TUM RGB-D, freiburg1: with a significant sixth-order term.
Camera with_k3() {
  return {
      CameraModel::radial_tangential, 640, 480, 517.3, 516.5, 318.6, 255.3, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};
}

// TUM VI, cam0.
Camera fisheye() {
  return {CameraModel::equidistant,
          512,
          512,
          190.978,
          190.973,
          254.931,
          256.897,
          {0.0034823, 0.00071503, -0.0020532, 0.00020293, 0.0}};
}

// r (1 - r^2 / 3) increases up to r = 1 and decreases beyond.
Camera folding_at_radius_one() {
  return {CameraModel::radial_tangential, 640, 480, 300.0, 300.0, 320.0, 240.0, {-1.0 / 3.0, 0.0, 0.0, 0.0, 0.0}};
}

struct Lens {
  const char* name;
  Camera camera;
};

void PrintTo(const Lens& lens, std::ostream* out) {
  *out << lens.name;
}

class EveryCamera : public testing::TestWithParam<Lens> {};

TEST_P(EveryCamera, InvertsTheProjection) {
  const Camera& camera = GetParam().camera;
  int tried = 0;
  for (double v = 0.5; v < camera.height; v += 23.0) {
    for (double u = 0.5; u < camera.width; u += 23.0) {
      const Eigen::Vector2d pixel(u, v);
      const std::optional<Eigen::Vector3d> bearing = camera.bearing(pixel);
      if (!bearing) continue;
      ++tried;
      EXPECT_NEAR(bearing->norm(), 1.0, 1e-12);
      EXPECT_THAT(camera.project(*bearing), Optional(PointNear(pixel, 1e-9)));
    }
  }
  EXPECT_GT(tried, 200);
}

TEST_P(EveryCamera, ProjectsADirectionToOnePixelAtEveryDepth) {
  const Camera& camera = GetParam().camera;
  const Eigen::Vector3d direction(0.3, -0.2, 1.0);
  ASSERT_TRUE(camera.project(direction).has_value());
  EXPECT_THAT(camera.project(1e-3 * direction), Optional(PointNear(*camera.project(direction), 1e-9)));
  EXPECT_THAT(camera.project(1e6 * direction), Optional(PointNear(*camera.project(direction), 1e-9)));
}

TEST_P(EveryCamera, ProjectsItsAxisToThePrincipalPoint) {
  const Camera& camera = GetParam().camera;
  EXPECT_THAT(camera.project({0.0, 0.0, 2.0}), Optional(PointNear(Eigen::Vector2d(camera.cx, camera.cy), 1e-12)));
  EXPECT_THAT(camera.bearing({camera.cx, camera.cy}), Optional(PointNear(Eigen::Vector3d(0.0, 0.0, 1.0), 1e-12)));
}

TEST_P(EveryCamera, RejectsPointsBehindAndBeside) {
  EXPECT_THAT(GetParam().camera.project({0.1, 0.1, -1.0}), Eq(std::nullopt));
  EXPECT_THAT(GetParam().camera.project({1.0, 0.0, 0.0}), Eq(std::nullopt));
  EXPECT_THAT(GetParam().camera.project({0.0, 0.0, std::nan("")}), Eq(std::nullopt));
}

INSTANTIATE_TEST_SUITE_P(Lenses, EveryCamera,
                         testing::Values(Lens{"Pinhole", pinhole()}, Lens{"RadialTangential", radial_tangential()},
                                         Lens{"RadialTangentialWithK3", with_k3()}, Lens{"Fisheye", fisheye()},
                                         Lens{"Folding", folding_at_radius_one()}),
                         [](const auto& tested) { return tested.param.name; });

TEST(PinholeCamera, DividesByDepth) {
  EXPECT_THAT(pinhole().project({1.0, -0.5, 2.0}), Optional(PointNear(Eigen::Vector2d(520.0, 137.5), 1e-12)));
}

// Expected pixels: the formulas of the models, written out.
TEST(RadialTangentialCamera, FollowsBrownConrady) {
  Camera camera{CameraModel::radial_tangential, 640, 480, 100.0, 100.0, 0.0, 0.0, {0.1, 0.01, 0.002, 0.003, 0.001}};
  const double x = 0.5, y = 0.4, s = 0.41;
  const double factor = 1.0 + 0.1 * s + 0.01 * s * s + 0.001 * s * s * s;
  const Eigen::Vector2d expected(100.0 * (x * factor + 2.0 * 0.002 * x * y + 0.003 * (s + 2.0 * x * x)),
                                 100.0 * (y * factor + 0.002 * (s + 2.0 * y * y) + 2.0 * 0.003 * x * y));
  EXPECT_THAT(camera.project({x, y, 1.0}), Optional(PointNear(expected, 1e-12)));
}

TEST(EquidistantCamera, IsLinearInTheAngleWithoutCoefficients) {
  Camera camera = fisheye();
  camera.distortion = {};
  const double angle = 1.2;
  const Eigen::Vector2d expected(camera.cx, camera.cy + camera.fy * angle);
  EXPECT_THAT(camera.project({0.0, std::sin(angle), std::cos(angle)}), Optional(PointNear(expected, 1e-9)));
}

TEST(EquidistantCamera, AddsOddPowersOfTheAngle) {
  Camera camera{CameraModel::equidistant, 640, 480, 100.0, 100.0, 0.0, 0.0, {0.1, 0.02, 0.003, 0.0004, 0.0}};
  const double angle = 0.8;
  const double bent = angle + 0.1 * std::pow(angle, 3) + 0.02 * std::pow(angle, 5) + 0.003 * std::pow(angle, 7) +
                      0.0004 * std::pow(angle, 9);
  EXPECT_THAT(camera.project({std::sin(angle), 0.0, std::cos(angle)}),
              Optional(PointNear(Eigen::Vector2d(100.0 * bent, 0.0), 1e-12)));
}

TEST(CameraField, EndsAtTheFoldOfTheLens) {
  const Camera camera = folding_at_radius_one();
  EXPECT_TRUE(camera.project({0.999, 0.0, 1.0}).has_value());
  EXPECT_FALSE(camera.project({1.001, 0.0, 1.0}).has_value());
}

TEST(CameraField, StaysClosedBeyondTheFold) {
  Camera camera = folding_at_radius_one();
  // The slope 1 - 2.5 s + s^2 is negative only for s in (0.5, 2).
  camera.distortion = {-2.5 / 3.0, 1.0 / 5.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(camera.project({std::sqrt(0.49), 0.0, 1.0}).has_value());
  EXPECT_FALSE(camera.project({std::sqrt(1.0), 0.0, 1.0}).has_value());
  EXPECT_FALSE(camera.project({std::sqrt(2.1), 0.0, 1.0}).has_value());
}

TEST(CameraField, StaysOpenForALensThatOnlyFlattens) {
  Camera camera = folding_at_radius_one();
  // The slope 1 - 1.99 s + s^2 has its minimum of 0.01 near s = 1.
  camera.distortion = {-1.99 / 3.0, 1.0 / 5.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(camera.project({2.0, 0.0, 1.0}).has_value());
}

TEST(CameraField, IsEmptyForUnreachablePixels) {
  const Camera camera = folding_at_radius_one();  // the farthest pixel is 300 * 2 / 3 from the centre
  EXPECT_THAT(camera.bearing({camera.cx + 199.9, camera.cy}), Optional(testing::_));
  EXPECT_THAT(camera.bearing({camera.cx + 200.1, camera.cy}), Eq(std::nullopt));
  EXPECT_THAT(fisheye().bearing({255.0 + 191.0 * std::numbers::pi, 257.0}), Eq(std::nullopt));
}

TEST(Camera, ContainsItsBorderPixels) {
  EXPECT_TRUE(pinhole().contains({0.0, 0.0}));
  EXPECT_TRUE(pinhole().contains({639.0, 479.0}));
  EXPECT_FALSE(pinhole().contains({639.5, 100.0}));
  EXPECT_FALSE(pinhole().contains({100.0, -0.5}));
}

TEST(CameraModel, HasNames) {
  EXPECT_EQ(to_string(CameraModel::pinhole), "pinhole");
  EXPECT_EQ(to_string(CameraModel::radial_tangential), "radial_tangential");
  EXPECT_EQ(to_string(CameraModel::equidistant), "equidistant");
}

}  // namespace
}  // namespace byre
