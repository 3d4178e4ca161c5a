#include "byre/features/rectify.h"

#include "byre/features/image_scene.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"

#include <cmath>
#include <numbers>
#include <ostream>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

using testing::HasSubstr;

Camera pinhole() {
  return {CameraModel::pinhole, 320, 240, 250.0, 250.0, 158.0, 121.0, {}};
}

// EuRoC, cam0 and cam1, at half the resolution.
Camera radial_tangential_left() {
  return {CameraModel::radial_tangential,
          376,
          240,
          229.3,
          228.6,
          183.6,
          124.2,
          {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
}
Camera radial_tangential_right() {
  return {CameraModel::radial_tangential,
          376,
          240,
          228.8,
          228.1,
          189.9,
          127.6,
          {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05, 0.0}};
}

// TUM VI, cam0, at half the resolution.
Camera equidistant() {
  return {CameraModel::equidistant,
          256,
          256,
          95.5,
          95.5,
          127.5,
          128.4,
          {0.0034823, 0.00071503, -0.0020532, 0.00020293, 0.0}};
}

// A lens with a field of view of 210 degrees.
Camera beyond_half_space() {
  return {CameraModel::equidistant, 320, 240, 87.3, 87.3, 159.5, 119.5, {0.001, -0.0005, 0.0, 0.0, 0.0}};
}

// Camera centred at right_in_left, rotated by a rotation vector.
Pose right_from_left(const Eigen::Vector3d& right_in_left, const Eigen::Vector3d& turn = Eigen::Vector3d::Zero()) {
  const Pose left_from_right{rotation_exp(turn), right_in_left};
  return inverse(left_from_right);
}

const Eigen::Vector3d kRightInLeft(0.11, 0.004, -0.003);
const Eigen::Vector3d kTurn(0.02, -0.03, 0.015);  // radians

struct Case {
  const char* name;
  Calibration calibration;
};

Calibration with_body(Calibration calibration) {
  calibration.body_from_left = {rotation_exp({0.3, -1.2, 0.4}), {0.1, 0.2, -0.3}};
  return calibration;
}

std::vector<Case> distorted_pairs() {
  const Pose pose = right_from_left(kRightInLeft, kTurn);
  return {
      {"radial_tangential",
       with_body({radial_tangential_left(), StereoPartner{radial_tangential_right(), pose}, Pose{}})},
      {"equidistant", with_body({equidistant(), StereoPartner{equidistant(), pose}, Pose{}})},
      {"unequal", with_body({radial_tangential_left(), StereoPartner{equidistant(), pose}, Pose{}})},
      {"pinhole", with_body({pinhole(), StereoPartner{pinhole(), pose}, Pose{}})},
      {"mono", with_body({radial_tangential_left(), std::nullopt, Pose{}})},
      {"mono_fisheye", with_body({equidistant(), std::nullopt, Pose{}})},
      {"mono_beyond_half_space", with_body({beyond_half_space(), std::nullopt, Pose{}})},
  };
}

class RectifyDistorted : public testing::TestWithParam<Case> {};
std::ostream& operator<<(std::ostream& stream, const Case& tested) {
  return stream << tested.name;
}
INSTANTIATE_TEST_SUITE_P(Rectifier, RectifyDistorted, testing::ValuesIn(distorted_pairs()),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

constexpr double kSlope = 40.0;  // grey values per pixel

// Linear ramp of grey values along an axis (0: columns, 1: rows), 128 at a position, clipped to the range of grey
// values.
cv::Mat ramp_image(const Camera& camera, int axis, double place) {
  cv::Mat image(camera.height, camera.width, CV_8U);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u)
      image.at<std::uint8_t>(v, u) = to_grey(128.0 + kSlope * ((axis ? v : u) - place));
  }
  return image;
}

// Source pixel of a rectified pixel, measured with ramps about the expected position.
template <typename Rectify>
Eigen::Vector2d source_of(const Eigen::Vector2d& pixel, const Camera& camera, const Eigen::Vector2d& expected,
                          Rectify rectify) {
  Eigen::Vector2d source;
  for (int axis = 0; axis < 2; ++axis) {
    cv::Mat exact, value;
    rectify(ramp_image(camera, axis, expected[axis])).convertTo(exact, CV_32F);
    const cv::Mat place(1, 1, CV_32FC2, cv::Scalar(pixel.x(), pixel.y()));
    cv::remap(exact, value, place, cv::Mat(), cv::INTER_LINEAR);
    source[axis] = expected[axis] + (value.at<float>(0, 0) - 128.0) / kSlope;
  }
  return source;
}

// Points in the field of view of both cameras, in the body frame.
std::vector<Eigen::Vector3d> random_points_in_body(const Rig& rig, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0.0, rig.width - 1.0), v(0.0, rig.height - 1.0), depth(0.5, 20.0);
  std::vector<Eigen::Vector3d> points;
  while (points.size() < 50) {
    const Eigen::Vector2d pixel(u(random), v(random));
    const Eigen::Vector3d point_in_rectified = depth(random) * rig.ray(pixel);
    const StereoPixel seen = rig.project(point_in_rectified);
    if (rig.contains({seen.x() - seen.z(), seen.y()})) points.push_back(rig.body_from_camera * point_in_rectified);
  }
  return points;
}

// Maps are quantised to 1/32 pixel, and measured here by interpolation of whole grey values.
constexpr double kMapPrecision = 0.06;

TEST_P(RectifyDistorted, ShowsPointsAtTheirProjection) {
  const Calibration calibration = GetParam().calibration;
  const Rectifier rectifier(calibration);
  const Rig& rig = rectifier.rig();
  for (const Eigen::Vector3d& point_in_body : random_points_in_body(rig, 1)) {
    const auto source = calibration.left.project(inverse(calibration.body_from_left) * point_in_body);
    const StereoPixel expected = rig.project(inverse(rig.body_from_camera) * point_in_body);
    ASSERT_TRUE(source);
    const auto rectify = [&](const cv::Mat& image) { return rectifier.left(image); };
    EXPECT_THAT(source_of(expected.head<2>(), calibration.left, *source, rectify), PointNear(*source, kMapPrecision));
  }
}

TEST_P(RectifyDistorted, AlignsRowsAndShiftsByTheDisparity) {
  const Calibration calibration = GetParam().calibration;
  if (!calibration.right) return;  // one camera has no rows to align
  const Rectifier rectifier(calibration);
  const Rig& rig = rectifier.rig();
  for (const Eigen::Vector3d& point_in_body : random_points_in_body(rig, 2)) {
    const Eigen::Vector3d point_in_right =
        calibration.right->right_from_left * (inverse(calibration.body_from_left) * point_in_body);
    const auto source = calibration.right->camera.project(point_in_right);
    const StereoPixel expected = rig.project(inverse(rig.body_from_camera) * point_in_body);
    ASSERT_TRUE(source);
    const Eigen::Vector2d pixel(expected.x() - expected.z(), expected.y());
    const auto rectify = [&](const cv::Mat& image) { return rectifier.right(image); };
    EXPECT_THAT(source_of(pixel, calibration.right->camera, *source, rectify), PointNear(*source, kMapPrecision));
  }
}

TEST_P(RectifyDistorted, MapsEachPixelToAnOriginalPixel) {
  const Calibration calibration = GetParam().calibration;
  const Rig rig = Rectifier(calibration).rig();
  const Pose left_from_rectified = inverse(calibration.body_from_left) * rig.body_from_camera;
  constexpr double kSlack = 0.1;  // pixels: the field is estimated from samples along the border
  const auto inside = [&](const Camera& camera, const Eigen::Vector3d& ray) {
    const auto pixel = camera.project(ray);
    return pixel && pixel->x() > -kSlack && pixel->y() > -kSlack && pixel->x() < camera.width - 1 + kSlack &&
           pixel->y() < camera.height - 1 + kSlack;
  };
  for (int v = 0; v < rig.height; v += v < rig.height - 1 - 7 ? 7 : 1) {
    for (int u = 0; u < rig.width; u += u < rig.width - 1 - 7 ? 7 : 1) {
      const Eigen::Vector3d ray_in_left = left_from_rectified.rotation * rig.ray({u, v});
      EXPECT_TRUE(inside(calibration.left, ray_in_left)) << u << ", " << v;
      if (!calibration.right) continue;
      const Eigen::Vector3d ray_in_right = calibration.right->right_from_left.rotation * ray_in_left;
      EXPECT_TRUE(inside(calibration.right->camera, ray_in_right)) << u << ", " << v;
    }
  }
}

TEST_P(RectifyDistorted, ReturnsTheOriginalRowOfAPixel) {
  const Calibration calibration = GetParam().calibration;
  const Rectifier rectifier(calibration);
  const Rig& rig = rectifier.rig();
  const Pose left_from_rectified = inverse(calibration.body_from_left) * rig.body_from_camera;
  for (int v = 5; v < rig.height; v += 37) {
    for (int u = 5; u < rig.width; u += 41) {
      const auto source = calibration.left.project(left_from_rectified.rotation * rig.ray({u, v}));
      ASSERT_TRUE(source);
      EXPECT_NEAR(rectifier.source_row(Eigen::Vector2i(u, v).cast<float>()), source->y(), 1.01);
    }
  }
}

TEST_P(RectifyDistorted, KeepsSizeLeftCentreAndBaseline) {
  const Calibration calibration = GetParam().calibration;
  const Rig rig = Rectifier(calibration).rig();
  EXPECT_EQ(rig.width, calibration.left.width);
  EXPECT_EQ(rig.height, calibration.left.height);
  EXPECT_THAT(rig.body_from_camera.translation, PointNear(calibration.body_from_left.translation, 1e-12));
  EXPECT_EQ(rig.is_stereo(), calibration.right.has_value());
  EXPECT_NEAR(rig.baseline, calibration.right ? kRightInLeft.norm() : 0.0, 1e-12);
}

TEST(Rectifier, ReturnsARectifiedPairWithoutACopy) {
  const Calibration calibration{pinhole(), StereoPartner{pinhole(), right_from_left({0.2, 0.0, 0.0})},
                                Pose{rotation_exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}}};
  const Rectifier rectifier(calibration);
  const cv::Mat image(240, 320, CV_8U, cv::Scalar(1));
  EXPECT_EQ(rectifier.left(image).data, image.data);
  EXPECT_EQ(rectifier.right(image).data, image.data);
  const Rig& rig = rectifier.rig();
  EXPECT_EQ(rig.focal, 250.0);
  EXPECT_EQ(rig.cx, 158.0);
  EXPECT_EQ(rig.cy, 121.0);
  EXPECT_NEAR(rig.baseline, 0.2, 1e-15);
  EXPECT_THAT(rig.body_from_camera, PoseNear(calibration.body_from_left, 0.0, 1e-12));
}

TEST(Rectifier, ReturnsTheImageOfAnIdealCamera) {
  const Rectifier rectifier({pinhole(), std::nullopt, Pose{}});
  const cv::Mat image(240, 320, CV_8U, cv::Scalar(1));
  EXPECT_EQ(rectifier.left(image).data, image.data);
  EXPECT_FALSE(rectifier.rig().is_stereo());
}

TEST(Rectifier, RectifiesAPairOfUnequalSizes) {
  Camera right = pinhole();
  right.width = 300;
  right.height = 200;
  const Rectifier rectifier({pinhole(), StereoPartner{right, right_from_left({0.2, 0.0, 0.0})}, Pose{}});
  EXPECT_EQ(rectifier.right(cv::Mat(200, 300, CV_8U, cv::Scalar(1))).size(), cv::Size(320, 240));
}

TEST(Rectifier, KeepsAWideFieldAroundTheAxis) {
  const Pose pose = right_from_left(kRightInLeft, kTurn);
  const Rig rig = Rectifier({equidistant(), StereoPartner{equidistant(), pose}, Pose{}}).rig();
  EXPECT_NEAR(rig.cx, 0.5 * (rig.width - 1), 1.0);
  EXPECT_NEAR(rig.cy, 0.5 * (rig.height - 1), 1.0);
}

TEST(Rectifier, ChoosesAFocalLengthBetweenBlurAndCropping) {
  for (const Camera& camera : {equidistant(), beyond_half_space()}) {
    const Rig rig = Rectifier({camera, std::nullopt, Pose{}}).rig();
    EXPECT_GE(rig.focal, 0.5 * camera.fx) << "the centre would be coarser than half";
    const double field = 2.0 * std::atan(0.5 * (rig.width - 1) / rig.focal) * 180.0 / std::numbers::pi;
    EXPECT_GT(field, 100.0) << "degrees of the horizon";
    EXPECT_LT(field, 150.0) << "degrees of the horizon";
  }
}

// White half-plane z = 1, x cos(turn) + y sin(turn) > offset, seen by the camera, with a soft border.
cv::Mat image_of_half_plane(const Camera& camera, double turn, double offset) {
  constexpr double kSoftness = 0.04;
  cv::Mat image = cv::Mat::zeros(camera.height, camera.width, CV_8U);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto bearing = camera.bearing({double(u), double(v)});
      if (!bearing || bearing->z() < 0.05) continue;
      const Eigen::Vector2d on_plane = bearing->head<2>() / bearing->z();
      const double beyond = on_plane.x() * std::cos(turn) + on_plane.y() * std::sin(turn) - offset;
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(127.5 + 127.5 * beyond / kSoftness);
    }
  }
  return image;
}

// Column of a row at which the image changes from dark to bright.
std::optional<double> crossing(const cv::Mat& image, int row) {
  constexpr double kMiddle = 127.5;
  for (int u = 1; u < image.cols; ++u) {
    const double before = image.at<std::uint8_t>(row, u - 1), after = image.at<std::uint8_t>(row, u);
    if (before < kMiddle && after >= kMiddle) return u - 1 + (kMiddle - before) / (after - before);
  }
  return std::nullopt;
}

TEST(Rectifier, StraightensLinesOfAFisheye) {
  const Camera camera = equidistant();
  const Rectifier rectifier({camera, std::nullopt, Pose{}});
  const Rig& rig = rectifier.rig();
  for (const double offset : {-0.8, 0.1, 0.7}) {
    constexpr double kLean = 0.2;  // radians
    const cv::Mat rectified = rectifier.left(image_of_half_plane(camera, kLean, offset));
    int rows = 0;
    for (int row = rig.height / 6; row < rig.height * 5 / 6; ++row) {
      const double y = (row - rig.cy) / rig.focal;
      const double expected = rig.cx + rig.focal * (offset - y * std::sin(kLean)) / std::cos(kLean);
      const std::optional<double> found = crossing(rectified, row);
      ASSERT_TRUE(found) << row;
      EXPECT_NEAR(*found, expected, 0.25) << row;
      ++rows;
    }
    EXPECT_GT(rows, 100);
  }
}

TEST(Rectifier, LeavesTheInputImage) {
  const Rectifier rectifier({radial_tangential_left(), std::nullopt, Pose{}});
  const cv::Mat image = render(376, 240, Texture(3));
  const cv::Mat before = image.clone();
  EXPECT_NE(rectifier.left(image).data, image.data);
  EXPECT_EQ(cv::norm(image, before, cv::NORM_INF), 0.0);
}

std::string refusal(const Camera& camera, const Pose& pose) {
  try {
    const Rectifier rectifier({camera, StereoPartner{camera, pose}, Pose{}});
  } catch (const InputError& error) {
    return error.reason();
  }
  return "accepted";
}

TEST(Rectifier, RejectsSwappedCameras) {
  EXPECT_THAT(refusal(pinhole(), right_from_left({-0.11, 0.0, 0.0})), HasSubstr("not to the right"));
  EXPECT_THAT(refusal(equidistant(), right_from_left(-kRightInLeft, kTurn)), HasSubstr("not to the right"));
}

TEST(Rectifier, RejectsCamerasBehindEachOther) {
  EXPECT_THAT(refusal(pinhole(), Pose{}), HasSubstr("not to the right")) << "at the same place";
  EXPECT_EQ(refusal(pinhole(), right_from_left({0.0, 0.1, 0.0})), "accepted") << "below";
  EXPECT_THAT(refusal(pinhole(), right_from_left({0.0, 0.0, 0.1})),
              HasSubstr("in front of the left camera or behind it"))
      << "behind";
}

TEST(Rectifier, RejectsOppositeCameras) {
  for (const Camera& camera : {pinhole(), radial_tangential_left(), equidistant()}) {
    for (const double off : {0.0, 1e-9, 0.05}) {
      for (const Eigen::Vector3d axis : {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()}) {
        const Pose pose = right_from_left({0.1, 0.0, 0.0}, (std::numbers::pi - off) * axis);
        EXPECT_THROW(Rectifier({camera, StereoPartner{camera, pose}, Pose{}}), InputError) << off;
      }
    }
  }
  const Pose half_turn = inverse(Pose{Eigen::Quaterniond(0.0, 0.0, 1.0, 0.0), {0.1, 0.0, 0.0}});
  EXPECT_THROW(Rectifier({pinhole(), StereoPartner{pinhole(), half_turn}, Pose{}}), InputError);
}

TEST(Rectifier, RejectsABaselineInAnotherUnit) {
  Pose in_millimetres;
  in_millimetres.translation.x() = -110.0;
  EXPECT_THROW(Rectifier({pinhole(), StereoPartner{pinhole(), in_millimetres}, Pose{}}), InputError);
}

TEST(Rectifier, RejectsCamerasWithoutOverlap) {
  // Each has a horizontal field of view of 65 degrees; the viewing directions differ by 80.
  EXPECT_NE(refusal(pinhole(), right_from_left({0.1, 0.0, 0.0}, {0.0, 1.4, 0.0})), "accepted");
}

TEST(Rectifier, RejectsANonFiniteCalibration) {
  const Pose pose = right_from_left({0.1, 0.0, 0.0}, {0.0, std::nan(""), 0.0});
  EXPECT_THROW(Rectifier({pinhole(), StereoPartner{pinhole(), pose}, Pose{}}), InputError);
}

}  // namespace
}  // namespace byre
