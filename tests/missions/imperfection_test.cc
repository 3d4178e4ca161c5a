#include "imperfection.h"

#include "byre/features/image_scene.h"
#include "byre/simulation/rendered_room_scene.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr Imperfection kExact{CameraCondition::exact, 1};
constexpr Imperfection kGood{CameraCondition::good, 1};
constexpr Imperfection kWorn{CameraCondition::worn, 1};

ImageFrame two_textures() {
  return {from_seconds(3.0), to_image(render(376, 240, Texture(71, 0.6))),
          to_image(render(376, 240, Texture(72, 0.6)))};
}

// Mean difference of horizontal neighbours in a window a tenth of the image wide and high; x, y: its corner, relative
// to the size.
double detail(const Image& image, double x, double y) {
  const int left = static_cast<int>(x * image.width), top = static_cast<int>(y * image.height);
  double sum = 0.0;
  for (int row = top; row < top + image.height / 10; ++row) {
    for (int column = left; column < left + image.width / 10; ++column) {
      const auto i = static_cast<std::size_t>(row * image.width + column);
      sum += std::abs(int{image.pixels[i + 1]} - int{image.pixels[i]});
    }
  }
  return sum;
}

double mean(const Image& image) {
  double sum = 0.0;
  for (const std::uint8_t grey : image.pixels) sum += grey;
  return sum / static_cast<double>(image.pixels.size());
}

TEST(Imperfection, OfAnExactCameraChangesNothing) {
  const ImageFrame images = two_textures(), seen = imperfect_cameras(kExact)(images, 4);
  EXPECT_EQ(seen.left.pixels, images.left.pixels);
  EXPECT_EQ(seen.right->pixels, images.right->pixels);
  const Calibration calibration = euroc_like_calibration(1), told = nominal_calibration(calibration, kExact);
  EXPECT_EQ(told.left.fx, calibration.left.fx);
  EXPECT_EQ(told.right->right_from_left.translation, calibration.right->right_from_left.translation);
}

TEST(Imperfection, IsIndependentOfEarlierFrames) {
  const ImageFrame images = two_textures();
  const Degradation first = imperfect_cameras(kWorn), second = imperfect_cameras(kWorn);
  first({images.time, *images.right, images.left}, 0);
  const ImageFrame seen = first(images, 1), again = second(images, 0);
  EXPECT_EQ(seen.time, images.time);
  EXPECT_EQ(seen.left.pixels, again.left.pixels);
  EXPECT_EQ(seen.right->pixels, again.right->pixels);
  EXPECT_FALSE(first({images.time, images.left, std::nullopt}, 2).right) << "one camera stays one camera";
}

TEST(Imperfection, BlursTheCornersMoreThanTheCentreAndMoreIfWorn) {
  const ImageFrame images = two_textures();
  const auto kept = [&](const Imperfection& imperfection, double x, double y) {
    return detail(imperfect_cameras(imperfection)(images, 0).left, x, y) / detail(images.left, x, y);
  };
  EXPECT_GT(kept(kGood, 0.45, 0.45), 0.995);
  EXPECT_LT(kept(kGood, 0.0, 0.85), 0.99);
  EXPECT_LT(kept(kWorn, 0.0, 0.85), kept(kGood, 0.0, 0.85) - 0.05);
}

TEST(Imperfection, BrightensTheRightImageOnly) {
  const ImageFrame images = two_textures(), seen = imperfect_cameras(kGood)(images, 0);
  EXPECT_NEAR(mean(seen.left), mean(images.left), 0.2);
  EXPECT_NEAR(mean(seen.right.value()), 1.02 * mean(images.right.value()) + 1.0, 0.3);
}

TEST(Imperfection, HasAnErrorPerSeedThatGrowsWithWear) {
  const Calibration calibration = euroc_like_calibration(1);
  const auto focal_error = [&](const Imperfection& imperfection) {
    return nominal_calibration(calibration, imperfection).left.fx - calibration.left.fx;
  };
  EXPECT_NE(focal_error(kGood), 0.0);
  EXPECT_NE(focal_error(kGood), focal_error({CameraCondition::good, 2}));
  EXPECT_NEAR(focal_error(kWorn), 3.0 * focal_error(kGood), 1e-9);
}

TEST(Imperfection, HasDistinctNames) {
  EXPECT_EQ(name_of(kExact), name_of({CameraCondition::exact, 2}));
  EXPECT_EQ(name_of(kGood), "good_1");
  EXPECT_NE(name_of(kGood), name_of({CameraCondition::good, 2}));
  EXPECT_NE(name_of(kGood), name_of(kWorn));
}

}  // namespace
}  // namespace byre
