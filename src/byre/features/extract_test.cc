#include "byre/features/extract.h"

#include "byre/features/image_scene.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr int kWidth = 376;
constexpr int kHeight = 240;
constexpr double kFocal = 230.0;    // pixels
constexpr double kBaseline = 0.11;  // metres

Camera ideal_camera() {
  return {CameraModel::pinhole, kWidth, kHeight, kFocal, kFocal, 187.5, 119.5, {}};
}

Calibration ideal_pair() {
  return {ideal_camera(), StereoPartner{ideal_camera(), {Eigen::Quaterniond::Identity(), {-kBaseline, 0.0, 0.0}}},
          Pose{}};
}

// A textured wall seen by two cameras: the plane z = depth of the left camera frame.
struct Wall {
  Texture texture;
  double depth = 2.0;               // metres
  double pixels_per_metre = 115.0;  // the texture's resolution

  Image render_view(const Camera& camera, const Pose& camera_from_left) const {
    const Pose left_from_camera = inverse(camera_from_left);
    return to_image(render(camera.width, camera.height, [&](double u, double v) {
      const auto bearing = camera.bearing({u, v});
      if (!bearing) return 0.0;
      const Eigen::Vector3d direction = left_from_camera.rotation * *bearing;
      const double range = (depth - left_from_camera.translation.z()) / direction.z();
      const Eigen::Vector3d point = left_from_camera.translation + range * direction;
      return texture(pixels_per_metre * point.x(), pixels_per_metre * point.y());
    }));
  }

  ImageFrame render_view(const Calibration& calibration) const {
    ImageFrame images{from_seconds(12.5), render_view(calibration.left, Pose{}), std::nullopt};
    if (calibration.right) images.right = render_view(calibration.right->camera, calibration.right->right_from_left);
    return images;
  }
};

Wall wall() {
  return {Texture(51, 0.8)};
}

double share_with_disparity(const Features& features) {
  const auto count = std::count_if(features.keypoints().begin(), features.keypoints().end(),
                                   [](const Keypoint& keypoint) { return keypoint.has_disparity(); });
  return static_cast<double>(count) / features.size();
}

TEST(Extractor, ReturnsADescriptorAndAPatchPerKeypoint) {
  Extractor extractor(ideal_pair(), {});
  const Extraction extraction = extractor.extract(wall().render_view(ideal_pair()));
  const Features& features = *extraction.frame.features;
  EXPECT_EQ(extraction.frame.time, from_seconds(12.5));
  EXPECT_GE(features.size(), 500);
  EXPECT_LE(features.size(), ExtractOptions().max_features);
  EXPECT_EQ(features.descriptors().size(), features.keypoints().size());
  for (int i = 0; i < features.size(); ++i) EXPECT_NE(features.find_patch(i), nullptr);
}

double mean_of(const Image& image) {
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) / static_cast<double>(image.pixels.size());
}

TEST(Extractor, ReturnsAReducedPictureIfRequested) {
  ImageFrame images = wall().render_view(ideal_pair());
  Extractor extractor(ideal_pair(), {.picture = true});
  const std::shared_ptr<const Image> picture = extractor.extract(images).frame.picture;
  ASSERT_TRUE(picture);
  EXPECT_LE(std::max(picture->width, picture->height), 376);
  EXPECT_EQ(picture->pixels.size(), static_cast<std::size_t>(picture->width * picture->height));
  EXPECT_NEAR(mean_of(*picture), mean_of(images.left), 1.5);
  const Image kept = *picture;
  std::ranges::fill(images.left.pixels, std::uint8_t{0});
  for (int i = 0; i < 10; ++i) extractor.extract(images);
  EXPECT_EQ(picture->pixels, kept.pixels) << "later frames do not change it";
  EXPECT_FALSE(Extractor(ideal_pair(), {}).extract(images).frame.picture);
}

TEST(Extractor, ReturnsTheReadoutTimeOfKeypointRows) {
  Extractor extractor(ideal_pair(), {});
  const Extraction extraction = extractor.extract(wall().render_view(ideal_pair()));
  const auto height = static_cast<float>(ideal_pair().left.height);
  for (const Keypoint& keypoint : extraction.frame.features->keypoints()) {
    EXPECT_NEAR(keypoint.row_time, (keypoint.pixel.y() + 0.5f) / height - 0.5f, 1e-6f);
  }
}

TEST(Extractor, MeasuresTheConditionOfTheLeftImage) {
  ImageFrame images = wall().render_view(ideal_pair());
  Extractor extractor(ideal_pair(), {});
  const std::optional<ImageCondition> seen = extractor.extract(images).frame.condition;
  ASSERT_TRUE(seen);
  EXPECT_EQ(fault_of(*seen, {}), ImageFault::none);
  EXPECT_EQ(seen->sharpness, measure_condition(images.left).sharpness) << "before rectification";
  std::ranges::fill(images.left.pixels, std::uint8_t{0});
  EXPECT_EQ(fault_of(*extractor.extract(images).frame.condition, {}), ImageFault::dark);
}

TEST(Extractor, FillsTheQuotaIfPossible) {
  for (const int wanted : {1, 100, 300}) {
    Extractor extractor(ideal_pair(), {wanted});
    EXPECT_EQ(extractor.extract(wall().render_view(ideal_pair())).frame.features->size(), wanted);
  }
}

TEST(Extractor, UsesAllOctaves) {
  Extractor extractor(ideal_pair(), {});
  const Extraction extraction = extractor.extract(wall().render_view(ideal_pair()));
  std::array<int, kOctaves> count{};
  for (const Keypoint& keypoint : extraction.frame.features->keypoints()) ++count[keypoint.octave];
  EXPECT_GE(*std::min_element(count.begin(), count.end()), 20);
}

TEST(Extractor, MeasuresTheDisparityOfAWall) {
  Extractor extractor(ideal_pair(), {});
  const Wall seen = wall();
  const auto features = extractor.extract(seen.render_view(ideal_pair())).frame.features;
  const double expected = kFocal * kBaseline / seen.depth;  // 12.65 pixels
  EXPECT_GE(share_with_disparity(*features), 0.9);
  for (const Keypoint& keypoint : features->keypoints()) {
    if (!keypoint.has_disparity()) continue;
    EXPECT_GT(keypoint.disparity_sigma, 0.0f);
    EXPECT_NEAR(keypoint.disparity, expected, 3.0 * keypoint.disparity_sigma);
  }
}

TEST(Extractor, MeasuresInTheRigOfADistortedPair) {
  const Camera left{CameraModel::radial_tangential,
                    kWidth,
                    kHeight,
                    229.3,
                    228.6,
                    183.6,
                    124.2,
                    {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
  const Camera right{CameraModel::radial_tangential,
                     kWidth,
                     kHeight,
                     228.8,
                     228.1,
                     189.9,
                     127.6,
                     {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05, 0.0}};
  const Pose left_from_right{rotation_exp({0.014, 0.0025, 0.0071}), {0.11, 0.0003, 0.0008}};
  const Calibration calibration{left, StereoPartner{right, inverse(left_from_right)}, Pose{}};
  const Wall seen = wall();
  Extractor extractor(calibration, {});
  const auto features = extractor.extract(seen.render_view(calibration)).frame.features;
  EXPECT_GE(share_with_disparity(*features), 0.8);
  int on_wall = 0, measured = 0;
  for (const Keypoint& keypoint : features->keypoints()) {
    if (!keypoint.has_disparity()) continue;
    const StereoPixel pixel(keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity);
    const double depth = (extractor.rig().body_from_camera * extractor.rig().triangulate(pixel)).z();
    const double depth_sigma = depth * keypoint.disparity_sigma / keypoint.disparity;
    ++measured;
    on_wall += std::abs(depth - seen.depth) <= 2.0 * depth_sigma ? 1 : 0;
  }
  EXPECT_GE(static_cast<double>(on_wall), 0.95 * measured);
}

TEST(Extractor, IsDeterministic) {
  const ImageFrame images = wall().render_view(ideal_pair());
  Extractor used(ideal_pair(), {});
  used.extract(Wall{Texture(52)}.render_view(ideal_pair()));  // leaves other images in the working memory
  Extractor fresh(ideal_pair(), {});
  const auto first = used.extract(images).frame.features;
  const auto second = fresh.extract(images).frame.features;
  ASSERT_EQ(first->size(), second->size());
  EXPECT_TRUE(std::ranges::equal(first->descriptors(), second->descriptors()));
  for (int i = 0; i < first->size(); ++i) {
    const Keypoint &a = first->keypoint(i), &b = second->keypoint(i);
    EXPECT_EQ(a.pixel, b.pixel);
    EXPECT_EQ(std::tuple(a.disparity, a.disparity_sigma, a.angle, a.response, a.octave),
              std::tuple(b.disparity, b.disparity_sigma, b.angle, b.response, b.octave));
    EXPECT_EQ(first->find_patch(i)->pixels, second->find_patch(i)->pixels);
    EXPECT_EQ(first->find_patch(i)->centre, second->find_patch(i)->centre);
  }
}

TEST(Extractor, IsDeterministicAfterAPause) {
  Extractor extractor(ideal_pair(), {});
  const ImageFrame images = wall().render_view(ideal_pair());
  const Extraction before = extractor.extract(images);
  extractor.rest();
  const Extraction after = extractor.extract(images);
  EXPECT_TRUE(std::ranges::equal(after.frame.features->descriptors(), before.frame.features->descriptors()));
  EXPECT_EQ(share_with_disparity(*after.frame.features), share_with_disparity(*before.frame.features));
}

TEST(Extractor, CutsThePatchAroundEachKeypoint) {
  const ImageFrame images = wall().render_view(ideal_pair());
  Extractor extractor(ideal_pair(), {});
  const auto features = extractor.extract(images).frame.features;
  for (int i = 0; i < features->size(); ++i) {
    const Keypoint& keypoint = features->keypoint(i);
    if (keypoint.octave > 0) continue;
    const Patch& patch = *features->find_patch(i);
    const int left = static_cast<int>(keypoint.pixel.x() - patch.centre.x());
    const int top = static_cast<int>(keypoint.pixel.y() - patch.centre.y());
    for (const int corner : {0, Patch::kSize - 1}) {
      EXPECT_EQ(patch.pixels[static_cast<std::size_t>(corner * Patch::kSize + corner)],
                images.left.pixels[static_cast<std::size_t>((top + corner) * kWidth + left + corner)]);
    }
  }
}

TEST(Extractor, RefinesDisparitiesToSubPixels) {
  const Extraction extraction = Extractor(ideal_pair(), {}).extract(wall().render_view(ideal_pair()));
  std::vector<double> errors;
  for (const Keypoint& keypoint : extraction.frame.features->keypoints()) {
    if (keypoint.has_disparity()) errors.push_back(std::abs(keypoint.disparity - kFocal * kBaseline / wall().depth));
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  EXPECT_LT(*middle, 0.2);
}

TEST(Extractor, ReturnsNoDisparitiesWithoutARightImage) {
  ImageFrame images = wall().render_view(ideal_pair());
  Extractor extractor(ideal_pair(), {});
  const auto with_right = extractor.extract(images).frame.features;
  images.right.reset();
  const auto features = extractor.extract(images).frame.features;
  EXPECT_EQ(share_with_disparity(*features), 0.0);
  EXPECT_TRUE(std::ranges::equal(features->descriptors(), with_right->descriptors()))
      << "the left image alone determines the features";
}

TEST(Extractor, SkipsTheRightImageOnRequest) {
  const ImageFrame images = wall().render_view(ideal_pair());
  Extractor extractor(ideal_pair(), {});
  ImageFrame left = images;
  left.right.reset();
  const auto of_left = extractor.extract(left).frame;
  const auto told = extractor.extract(images, ImagesUsed::left).frame;
  EXPECT_TRUE(std::ranges::equal(told.features->descriptors(), of_left.features->descriptors()));
  EXPECT_EQ(share_with_disparity(*told.features), 0.0);
  EXPECT_FALSE(told.right_condition);
}

TEST(Extractor, IgnoresTheRightImageOfASingleCamera) {
  Extractor extractor({ideal_camera(), std::nullopt, Pose{}}, {});
  const auto features = extractor.extract(wall().render_view(ideal_pair())).frame.features;
  EXPECT_GE(features->size(), 500);
  EXPECT_EQ(share_with_disparity(*features), 0.0);
}

Calibration with_registered_depth() {
  return {ideal_camera(), std::nullopt, Pose{}, DepthCamera{}};
}

DepthImage even_depth(double metres) {
  const auto units = static_cast<std::uint16_t>(std::lround(5000.0 * metres));
  return {kWidth, kHeight, std::vector<std::uint16_t>(static_cast<std::size_t>(kWidth * kHeight), units)};
}

TEST(Extractor, ConvertsDepthsToDisparities) {
  ImageFrame images = wall().render_view(with_registered_depth());
  images.depth = even_depth(2.0);
  Extractor extractor(with_registered_depth(), {});
  ASSERT_TRUE(extractor.rig().is_stereo());
  const auto features = extractor.extract(images).frame.features;
  EXPECT_EQ(share_with_disparity(*features), 1.0);
  for (const Keypoint& keypoint : features->keypoints()) {
    const Eigen::Vector3d point =
        extractor.rig().triangulate({keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity});
    EXPECT_NEAR(point.z(), 2.0, 1e-5);
    EXPECT_GT(keypoint.disparity_sigma, 0.0f);
  }
}

TEST(Extractor, ReturnsNoDisparitiesWithoutADepthImage) {
  Extractor extractor(with_registered_depth(), {});
  const auto features = extractor.extract(wall().render_view(with_registered_depth())).frame.features;
  EXPECT_GE(features->size(), 500);
  EXPECT_EQ(share_with_disparity(*features), 0.0);
}

TEST(Extractor, RejectsDepthImagesOfAnotherSize) {
  ImageFrame images = wall().render_view(with_registered_depth());
  images.depth = DepthImage{2, 1, {1000, 1000}};
  Extractor extractor(with_registered_depth(), {});
  EXPECT_THROW(extractor.extract(images), InputError);
  images.depth = even_depth(2.0);
  images.depth->units.pop_back();
  EXPECT_THROW(extractor.extract(images), InputError);
}

TEST(Extractor, ReturnsNothingForABlankImage) {
  ImageFrame images{Timestamp{}, {kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 90)}, std::nullopt};
  images.right = images.left;
  Extractor extractor(ideal_pair(), {});
  EXPECT_EQ(extractor.extract(images).frame.features->size(), 0);
}

TEST(Extractor, AcceptsImagesTooSmallForMostOctaves) {
  for (const int side : {16, 38, 40, 47, 60, 75}) {
    Camera small = ideal_camera();
    small.width = small.height = side;
    small.cx = small.cy = 0.5 * (side - 1);
    Calibration calibration = ideal_pair();
    calibration.left = calibration.right->camera = small;
    Extractor extractor(calibration, {});
    const auto features = extractor.extract(wall().render_view(calibration)).frame.features;
    EXPECT_LE(features->size(), std::max(0, side - 38) * std::max(0, side - 38)) << "none is on the border";
    EXPECT_TRUE(features->size() > 0 || side < 60) << side;
    for (const Keypoint& keypoint : features->keypoints()) EXPECT_LE(keypoint.octave, 2);
  }
}

TEST(Extractor, IsMovable) {
  Extractor first(ideal_pair(), {100});
  Extractor second = std::move(first);
  EXPECT_EQ(second.rig().width, kWidth);
  EXPECT_GT(second.extract(wall().render_view(ideal_pair())).frame.features->size(), 50);
}

TEST(Extractor, RejectsImagesOfAnotherSize) {
  Extractor extractor(ideal_pair(), {});
  const ImageFrame images = wall().render_view(ideal_pair());
  ImageFrame wrong = images;
  wrong.left.width = kHeight;
  wrong.left.height = kWidth;
  EXPECT_THROW(extractor.extract(wrong), InputError);
  wrong = images;
  wrong.right = Image{kWidth, kHeight - 1, std::vector<std::uint8_t>(kWidth * (kHeight - 1))};
  EXPECT_THROW(extractor.extract(wrong), InputError);
  EXPECT_NO_THROW(extractor.extract(images)) << "the next frame is accepted";
}

TEST(Extractor, RejectsImagesWithMissingPixels) {
  Extractor extractor(ideal_pair(), {});
  ImageFrame images = wall().render_view(ideal_pair());
  images.left.pixels.pop_back();
  EXPECT_THROW(extractor.extract(images), InputError);
}

TEST(Extractor, AcceptsCamerasOfDifferentSizes) {
  Calibration calibration = ideal_pair();
  calibration.right->camera.width += 40;
  calibration.right->camera.height += 20;
  const Wall seen = wall();
  Extractor extractor(calibration, {});
  const auto features = extractor.extract(seen.render_view(calibration)).frame.features;
  EXPECT_GE(share_with_disparity(*features), 0.9);
}

TEST(Extractor, RejectsACalibrationThatCannotBeRectified) {
  Calibration calibration = ideal_pair();
  calibration.right->right_from_left.translation = {kBaseline, 0.0, 0.0};
  EXPECT_THROW(Extractor(calibration, {}), InputError);
}

}  // namespace
}  // namespace byre
