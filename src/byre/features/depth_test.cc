#include "byre/features/depth.h"

#include "byre/features/rectify.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

namespace byre {
namespace {

Camera colour_lens() {
  return {CameraModel::pinhole, 160, 120, 130.0, 130.0, 79.5, 59.5, {}};
}

Calibration with_depth(const Camera& lens) {
  return {lens, std::nullopt, Pose{}, DepthCamera{.units_per_metre = 5000.0}};
}

Rig rig_of(const Calibration& calibration) {
  return Rectifier(calibration).rig();
}

// A plane through a point, in the left camera's frame.
struct Plane {
  Eigen::Vector3d point = {0.0, 0.0, 2.0};
  Eigen::Vector3d normal = {0.0, 0.0, -1.0};

  double range(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    return normal.dot(point - origin) / normal.dot(direction);
  }
};

// Depth image of a scene; range gives the distance along a ray of the left camera's frame.
DepthImage render_depth(const Camera& lens, const Pose& left_from_depth, double units_per_metre,
                        const std::function<double(const Eigen::Vector3d&, const Eigen::Vector3d&)>& range) {
  DepthImage image{lens.width, lens.height, {}};
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Eigen::Vector3d bearing = lens.bearing({u, v}).value();
      const double along = range(left_from_depth.translation, left_from_depth.rotation * bearing);
      image.units.push_back(static_cast<std::uint16_t>(std::lround(units_per_metre * along * bearing.z())));
    }
  }
  return image;
}

DepthImage registered_image(const Calibration& calibration, const Plane& plane) {
  return render_depth(calibration.left, {}, calibration.depth->units_per_metre,
                      [&](const auto& origin, const auto& direction) { return plane.range(origin, direction); });
}

// The same depth in all pixels; tests change some of them.
DepthImage even_image(const Camera& lens, std::uint16_t units) {
  return {
      lens.width, lens.height,
      std::vector<std::uint16_t>(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height), units)};
}

std::uint16_t& at(DepthImage& image, int u, int v) {
  return image.units[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(u)];
}

std::optional<DepthReading> read_at(const Calibration& calibration, const DepthImage& image,
                                    const Eigen::Vector2d& pixel, const DepthOptions& options = {}) {
  Keypoint keypoint;
  keypoint.pixel = pixel.cast<float>();
  return DepthReader(calibration, rig_of(calibration)).read(image, {keypoint}, options).at(0);
}

double depth_of(const DepthReading& reading, const Calibration& calibration) {
  const Rig rig = rig_of(calibration);
  return rig.focal * rig.baseline / reading.disparity;
}

TEST(DepthReader, ReturnsDepthsAsDisparities) {
  const Calibration calibration = with_depth(colour_lens());
  const auto reading = read_at(calibration, even_image(colour_lens(), 7500), {50.0, 40.0});
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->disparity, 130.0 * calibration.depth->baseline / 1.5, 1e-5);
  EXPECT_NEAR(rig_of(calibration).triangulate({50.0, 40.0, reading->disparity}).z(), 1.5, 1e-5);
}

TEST(DepthReader, AppliesUnitAndNoiseOfTheCamera) {
  Calibration calibration = with_depth(colour_lens());
  calibration.depth->units_per_metre = 1000.0;
  calibration.depth->sigma_at_one_metre = 0.004;
  for (const double depth : {1.0, 4.0}) {
    const auto reading =
        read_at(calibration, even_image(colour_lens(), static_cast<std::uint16_t>(1000 * depth)), {50.0, 40.0});
    ASSERT_TRUE(reading);
    EXPECT_NEAR(depth_of(*reading, calibration), depth, 1e-5);
    const double sigma_of_depth = reading->sigma * depth / reading->disparity;
    EXPECT_NEAR(sigma_of_depth, 0.004 * depth * depth, 1e-5) << "grows with the square";
  }
}

TEST(DepthReader, ReadsTheDistortedPixel) {
  Camera lens = colour_lens();
  lens.model = CameraModel::radial_tangential;
  lens.distortion = {-0.28, 0.07, 0.0002, 0.00002, 0.0};
  const Calibration calibration = with_depth(lens);
  const Rig rig = rig_of(calibration);
  const Plane slanted{{0.0, 0.0, 2.0}, Eigen::Vector3d(1.0, 0.3, -1.5).normalized()};
  const DepthImage image = registered_image(calibration, slanted);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(12.0, 10.0), {80.0, 60.0}, {140.0, 25.0}, {20.3, 101.7}}) {
    const auto reading = read_at(calibration, image, pixel);
    ASSERT_TRUE(reading) << pixel.transpose();
    EXPECT_NEAR(depth_of(*reading, calibration), slanted.range({0.0, 0.0, 0.0}, rig.ray(pixel)), 1e-3);
  }
}

TEST(DepthReader, EstimatesALargerSigmaOnASlantedSurface) {
  const Calibration calibration = with_depth(colour_lens());
  const Plane slanted{{0.0, 0.0, 2.0}, Eigen::Vector3d(2.0, 0.0, -1.0).normalized()};
  const auto upright = read_at(calibration, registered_image(calibration, {}), {79.5, 59.5});
  const auto reading = read_at(calibration, registered_image(calibration, slanted), {79.5, 59.5});
  ASSERT_TRUE(upright && reading);
  // One pixel aside, the inverse depth is off by tan(angle) / (focal depth).
  const double slope = 2.0 / 2.0 * calibration.depth->baseline;
  EXPECT_NEAR(reading->sigma, std::hypot(upright->sigma, slope), 2e-3);
}

TEST(DepthReader, DoesNotMixSurfacesAtAnEdge) {
  const Calibration calibration = with_depth(colour_lens());
  DepthImage image = even_image(colour_lens(), 15000);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < 80; ++u) at(image, u, v) = 6000;
  }
  for (double u = 70.0; u < 90.0; u += 0.25) {
    const auto reading = read_at(calibration, image, {u, 50.0});
    if (u < 79.5) {
      ASSERT_TRUE(reading) << u;
      EXPECT_NEAR(depth_of(*reading, calibration), 1.2, 1e-5) << u;
    } else if (u >= 81.5) {
      ASSERT_TRUE(reading) << u;
      EXPECT_NEAR(depth_of(*reading, calibration), 3.0, 1e-5) << u;
    } else if (reading) {
      EXPECT_NEAR(depth_of(*reading, calibration), 1.2, 1e-5) << u << ": at the edge the nearer one or none";
    }
  }
}

TEST(DepthReader, IsEmptyWithoutDepth) {
  const Calibration calibration = with_depth(colour_lens());
  DepthImage image = even_image(colour_lens(), 0);
  EXPECT_FALSE(read_at(calibration, image, {50.0, 40.0}));
  at(image, 50, 40) = 5000;
  EXPECT_FALSE(read_at(calibration, image, {50.0, 40.0})) << "one pixel alone may be wrong";
  for (int v = 38; v <= 42; ++v) at(image, 50, v) = at(image, 49, v) = 5000;
  EXPECT_TRUE(read_at(calibration, image, {50.0, 40.0})) << "adjacent holes have no effect";
  EXPECT_FALSE(read_at(calibration, even_image(colour_lens(), 65535), {50.0, 40.0})) << "13 m";
  EXPECT_TRUE(read_at(calibration, even_image(colour_lens(), 65535), {50.0, 40.0}, {.max_depth = 14.0}));
}

TEST(DepthReader, RejectsFlyingPixels) {
  const Calibration calibration = with_depth(colour_lens());
  DepthImage image = even_image(colour_lens(), 10000);
  at(image, 51, 41) = 3000;
  EXPECT_FALSE(read_at(calibration, image, {50.0, 40.0}));
  EXPECT_TRUE(read_at(calibration, image, {54.0, 40.0}));
}

// A depth camera 6 cm to the right, slightly rotated, with other intrinsics.
class RegisteredDepthReader : public testing::Test {
 protected:
  RegisteredDepthReader() : calibration_(with_depth(colour_lens())) {
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitY()));
    calibration_.depth->camera = Camera{CameraModel::pinhole, 128, 96, 90.0, 91.0, 62.0, 49.0, {}};
    calibration_.depth->left_from_depth = {turned, {0.06, 0.01, -0.005}};
  }

  DepthImage seen(const std::function<double(const Eigen::Vector3d&, const Eigen::Vector3d&)>& range) const {
    return render_depth(*calibration_.depth->camera, calibration_.depth->left_from_depth,
                        calibration_.depth->units_per_metre, range);
  }

  Calibration calibration_;
};

TEST_F(RegisteredDepthReader, IsRegisteredToTheColourCamera) {
  const Plane slanted{{0.0, 0.0, 1.5}, Eigen::Vector3d(0.5, -0.4, -1.0).normalized()};
  const DepthImage image = seen([&](const auto& from, const auto& along) { return slanted.range(from, along); });
  const Rig rig = rig_of(calibration_);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(40.0, 30.0), {80.0, 60.0}, {120.5, 90.5}}) {
    const auto reading = read_at(calibration_, image, pixel);
    ASSERT_TRUE(reading) << pixel.transpose();
    const double depth = slanted.range({0.0, 0.0, 0.0}, rig.ray(pixel));
    EXPECT_NEAR(depth_of(*reading, calibration_), depth, 0.01 * depth) << "within a pixel's step on the slope";
  }
}

TEST_F(RegisteredDepthReader, KeepsTheNearestOfTwoSurfaces) {
  const auto range = [](const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
    const double to_near = Plane{{0.0, 0.0, 0.8}}.range(from, along);
    const bool is_near = (from + to_near * along).x() > 0.0;
    return is_near ? to_near : Plane{{0.0, 0.0, 3.0}}.range(from, along);
  };
  const DepthImage image = seen(range);
  const Rig rig = rig_of(calibration_);
  for (double u = 60.0; u < 110.0; u += 1.0) {
    const auto reading = read_at(calibration_, image, {u, 60.0});
    const bool is_near = rig.ray({u, 60.0}).x() > 0.0;
    if (is_near && u > rig.cx + 3.0) {
      ASSERT_TRUE(reading) << u;
      EXPECT_NEAR(depth_of(*reading, calibration_), 0.8, 1e-3) << u;
    } else if (reading && u < rig.cx - 3.0) {
      EXPECT_NEAR(depth_of(*reading, calibration_), 3.0, 1e-2) << u;
    }
  }
}

}  // namespace
}  // namespace byre
