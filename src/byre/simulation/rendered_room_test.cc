#include "byre/simulation/rendered_room_scene.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/simulation/simulated_trajectory_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

RenderedRoom room_with_noise(double sigma) {
  RenderedRoomOptions options;
  options.noise_sigma = sigma;
  return RenderedRoom(options);
}

struct View {
  Camera camera;
  Pose world_from_camera;
  Image image;
};

View left_view(const RenderedRoom& room, const Calibration& calibration, const Pose& world_from_body) {
  return {calibration.left, world_from_body * calibration.body_from_left,
          room.render(calibration, world_from_body, {}).left};
}

View right_view(const RenderedRoom& room, const Calibration& calibration, const Pose& world_from_body) {
  const Pose world_from_left = world_from_body * calibration.body_from_left;
  return {calibration.right->camera, world_from_left * inverse(calibration.right->right_from_left),
          room.render(calibration, world_from_body, {}).right.value()};
}

Eigen::Vector3d point_seen(const RenderedRoom& room, const View& view, const Eigen::Vector2d& pixel) {
  const Eigen::Vector3d direction = view.world_from_camera.rotation * view.camera.bearing(pixel).value();
  const Eigen::Vector3d& origin = view.world_from_camera.translation;
  return origin + room.hit(origin.cast<float>(), direction.cast<float>()).distance * direction;
}

double grey_at(const Image& image, int column, int row) {
  return image.pixels[static_cast<std::size_t>(row * image.width + column)];
}

// Bilinear interpolation. Precondition: the pixel lies inside, not on the last row or column.
double grey_at(const Image& image, const Eigen::Vector2d& pixel) {
  const int column = static_cast<int>(pixel.x());
  const int row = static_cast<int>(pixel.y());
  const double x = pixel.x() - column;
  const double y = pixel.y() - row;
  return (1.0 - y) * ((1.0 - x) * grey_at(image, column, row) + x * grey_at(image, column + 1, row)) +
         y * ((1.0 - x) * grey_at(image, column, row + 1) + x * grey_at(image, column + 1, row + 1));
}

// Pixel in the second view of the surface point at a pixel of the first; empty outside the image or when occluded.
std::optional<Eigen::Vector2d> same_place(const RenderedRoom& room, const View& first, const View& second,
                                          const Eigen::Vector2d& pixel_in_first) {
  const Eigen::Vector3d point = point_seen(room, first, pixel_in_first);
  const auto pixel = second.camera.project(inverse(second.world_from_camera) * point);
  if (!pixel || pixel->minCoeff() < 1.0) return std::nullopt;
  if (pixel->x() > second.image.width - 2 || pixel->y() > second.image.height - 2) return std::nullopt;
  if ((point_seen(room, second, *pixel) - point).norm() > 0.01) return std::nullopt;
  return pixel;
}

struct Difference {
  double warped = 0.0;    // mean absolute grey difference at the same surface point
  double unwarped = 0.0;  // mean absolute grey difference at the same pixel
  int count = 0;
};

Difference compare(const RenderedRoom& room, const View& first, const View& second) {
  Difference difference;
  for (int row = 2; row < first.image.height - 2; row += 3) {
    for (int column = 2; column < first.image.width - 2; column += 3) {
      const auto pixel = same_place(room, first, second, {column, row});
      if (!pixel) continue;
      const double grey = grey_at(first.image, column, row);
      difference.warped += std::abs(grey_at(second.image, *pixel) - grey);
      difference.unwarped += std::abs(grey_at(second.image, column, row) - grey);
      ++difference.count;
    }
  }
  difference.warped /= difference.count;
  difference.unwarped /= difference.count;
  return difference;
}

class RenderedViews : public ::testing::Test {
 protected:
  const RenderedRoom room = room_with_noise(0.0);
  const Calibration calibration = euroc_like_calibration(2);
  const Trajectory trajectory = circling_trajectory(60, 20.0, 1.2, 1.0, calibration.body_from_left);
};

TEST_F(RenderedViews, AreConsistentBetweenBothCameras) {
  const Pose& world_from_body = trajectory[10].world_from_body;
  const Difference difference =
      compare(room, left_view(room, calibration, world_from_body), right_view(room, calibration, world_from_body));
  EXPECT_GT(difference.count, 6000);
  EXPECT_LT(difference.warped, 4.0);
  EXPECT_GT(difference.unwarped, 4.0 * difference.warped);
}

TEST_F(RenderedViews, AreConsistentOverTime) {
  const Difference difference = compare(room, left_view(room, calibration, trajectory[10].world_from_body),
                                        left_view(room, calibration, trajectory[12].world_from_body));
  EXPECT_GT(difference.count, 3000);
  EXPECT_LT(difference.warped, 4.0);
  EXPECT_GT(difference.unwarped, 4.0 * difference.warped);
}

TEST_F(RenderedViews, HaveContrastEverywhere) {
  const Image image = room.render(calibration, trajectory[0].world_from_body, {}).left;
  constexpr int kTile = 48;  // pixels
  for (int top = 0; top + kTile <= image.height; top += kTile) {
    for (int left = 0; left + kTile <= image.width; left += kTile) {
      double darkest = 255.0, brightest = 0.0;
      for (int i = 0; i < kTile * kTile; ++i) {
        const double grey = grey_at(image, left + i % kTile, top + i / kTile);
        darkest = std::min(darkest, grey);
        brightest = std::max(brightest, grey);
      }
      EXPECT_GT(brightest - darkest, 60.0) << "around " << left << ", " << top;
    }
  }
}

TEST(RenderedRoom, IsDeterministic) {
  const Calibration calibration = euroc_like_calibration(4);
  const Pose pose = circling_trajectory(2, 1.0, 1.0, 0.3, calibration.body_from_left)[1].world_from_body;
  const Timestamp time = std::chrono::milliseconds(50);
  const ImageFrame first = room_with_noise(2.0).render(calibration, pose, time);
  const ImageFrame second = room_with_noise(2.0).render(RenderedCameras(calibration), pose, time);
  EXPECT_EQ(first.time, time);
  EXPECT_EQ(first.left.pixels, second.left.pixels);
  EXPECT_EQ(first.right->pixels, second.right->pixels);
}

TEST(RenderedRoom, RendersNoRightImageForOneCamera) {
  Calibration calibration = euroc_like_calibration(4);
  calibration.right.reset();
  EXPECT_FALSE(room_with_noise(0.0).render(calibration, {}, {}).right);
}

std::vector<double> differences(const Image& first, const Image& second) {
  std::vector<double> all;
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    all.push_back(static_cast<double>(first.pixels[i]) - second.pixels[i]);
  }
  return all;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += (value - mean(values)) * (value - mean(values));
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(RenderedRoom, HasNoiseOfItsSigmaIndependentBetweenFrames) {
  constexpr double kSigma = 3.0;
  Calibration calibration = euroc_like_calibration(8);
  const Pose pose = circling_trajectory(2, 1.0, 1.0, 0.3, calibration.body_from_left)[0].world_from_body;
  const Image clean = room_with_noise(0.0).render(calibration, pose, Timestamp(1)).left;
  const Image noisy = room_with_noise(kSigma).render(calibration, pose, Timestamp(1)).left;
  const Image later = room_with_noise(kSigma).render(calibration, pose, Timestamp(2)).left;
  EXPECT_NEAR(mean(differences(noisy, clean)), 0.0, 0.2);
  EXPECT_NEAR(deviation(differences(noisy, clean)), kSigma, 0.2);
  EXPECT_NEAR(deviation(differences(noisy, later)), kSigma * std::sqrt(2.0), 0.3);
}

TEST(RenderedRoom, HasWallsAtItsSize) {
  RenderedRoomOptions options;
  options.room_size = {8.0, 6.0, 3.0};
  options.boxes = 0;
  const RenderedRoom room(options);
  const Eigen::Vector3f origin(1.0f, 0.5f, -0.5f);
  const SurfaceHit front = room.hit(origin, Eigen::Vector3f(2.0f, 0.1f, 0.1f));
  EXPECT_FLOAT_EQ(front.distance, 1.5f);
  EXPECT_EQ(front.axis, 0);
  EXPECT_TRUE(front.is_upper);
  const SurfaceHit floor = room.hit(origin, -Eigen::Vector3f::UnitZ());
  EXPECT_FLOAT_EQ(floor.distance, 1.0f);
  EXPECT_EQ(floor.axis, 2);
  EXPECT_FALSE(floor.is_upper);
}

TEST(RenderedRoom, HasBoxesInItsLowerThirdOnly) {
  RenderedRoomOptions options;
  options.boxes = 50;
  const RenderedRoom room(options);
  int on_boxes = 0;
  for (double x = -3.9; x < 4.0; x += 0.1) {
    for (double y = -2.9; y < 3.0; y += 0.1) {
      const SurfaceHit below = room.hit(Eigen::Vector3d(x, y, -0.5).cast<float>(), -Eigen::Vector3f::UnitZ());
      on_boxes += below.box > 0 ? 1 : 0;
      EXPECT_EQ(below.axis, 2) << "a box reaches above the lower third at " << x << ", " << y;
    }
  }
  EXPECT_GT(on_boxes, 100);
}

TEST(RenderedRoom, RejectsInvalidOptions) {
  RenderedRoomOptions flat;
  flat.room_size.z() = 0.0;
  EXPECT_THROW(RenderedRoom{flat}, InputError);
  RenderedRoomOptions few;
  few.boxes = -1;
  EXPECT_THROW(RenderedRoom{few}, InputError);
  RenderedRoomOptions noisy;
  noisy.noise_sigma = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(RenderedRoom{noisy}, InputError);
}

TEST(EurocLikeCalibration, KeepsItsFieldOfViewWhenDivided) {
  const Calibration full = euroc_like_calibration(1);
  const Calibration half = euroc_like_calibration(2);
  EXPECT_EQ(full.left.width, 752);
  EXPECT_EQ(half.left.width, 376);
  EXPECT_EQ(half.left.height, 240);
  EXPECT_THAT(half.left.bearing({-0.5, -0.5}).value(), PointNear(full.left.bearing({-0.5, -0.5}).value(), 1e-9));
  EXPECT_THAT(half.left.bearing({375.5, 239.5}).value(), PointNear(full.left.bearing({751.5, 479.5}).value(), 1e-9));
}

TEST(EurocLikeCalibration, HasABaselineOfElevenCentimetres) {
  const Pose right_from_left = euroc_like_calibration(1).right.value().right_from_left;
  EXPECT_THAT(right_from_left, PoseNear(Pose{Eigen::Quaterniond::Identity(), {-0.11, 0.0, 0.0}}, 0.002, 0.02));
}

}  // namespace
}  // namespace byre
