#include "byre/io/recording/fitting_pair.h"

#include "byre/geometry/rectification.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 320, kHeight = 240;
constexpr double kFocal = 250.0;

// Squares of random brightness at three distances, in the camera with its centre `shift` pixels to the right.
Image texture(int frame, int shift, int row_shift = 0) {
  Image image{kWidth, kHeight, std::vector<std::uint8_t>(static_cast<std::size_t>(kWidth * kHeight), 128)};
  std::mt19937 random(static_cast<unsigned>(frame));
  for (int square = 0; square < 700; ++square) {
    const int u = static_cast<int>(random() % (kWidth + 40)) - 20, v = static_cast<int>(random() % kHeight) + row_shift;
    const int side = 3 + static_cast<int>(random() % 12);
    const auto grey = static_cast<std::uint8_t>(40 + random() % 180);
    for (int y = std::max(0, v); y < std::min(v + side, kHeight); ++y) {
      for (int x = std::max(0, u - shift); x < std::min(u + side - shift, kWidth); ++x) {
        image.pixels[static_cast<std::size_t>(y * kWidth + x)] = grey;
      }
    }
  }
  return image;
}

Camera camera() {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = kFocal;
  camera.cx = 160.0;
  camera.cy = 120.0;
  return camera;
}

// The right camera's principal point is lower, so that a match needs the calibration of the right lens.
constexpr int kLower = 8;  // pixels

Calibration right_calibration() {
  Calibration pair;
  pair.left = camera();
  pair.right = StereoPartner{camera(), {Eigen::Quaterniond::Identity(), {-0.1, 0.0, 0.0}}};
  pair.right->camera.cy += kLower;
  return pair;
}

Calibration with_cameras_exchanged(const Calibration& pair) {
  return {.left = pair.right->camera,
          .right = StereoPartner{pair.left, inverse(pair.right->right_from_left)},
          .body_from_left = inverse(pair.right->right_from_left)};
}

// Ten frames a second of a pair in front of a wall.
class WallRecording final : public Recording {
 public:
  using Change = std::function<void(ImageFrame& images, int index)>;

  explicit WallRecording(Calibration calibration, Change change = {}, int disparity = 12)
      : calibration_(std::move(calibration)), change_(std::move(change)), disparity_(disparity) {
    for (int i = 0; i < 60; ++i) times_.push_back(from_seconds(0.1 * i));
    motion_.left_from_gyroscope = Eigen::Quaterniond::Identity();
  }

  const Calibration& calibration() const override { return calibration_; }
  const std::vector<Timestamp>& times() const override { return times_; }
  const MotionSamples& motion() const override { return motion_; }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  std::optional<ImageFrame> read(int index) override {
    ++reads;
    ImageFrame images{times_[static_cast<std::size_t>(index)], texture(index, 0), texture(index, disparity_, kLower)};
    if (change_) change_(images, index);
    if (!images.right) warnings_.push_back("no right image");
    return images;
  }

  int reads = 0;

 private:
  Calibration calibration_;
  Change change_;
  int disparity_;
  std::vector<Timestamp> times_;
  MotionSamples motion_;
  std::vector<std::string> warnings_;
};

void exchange(ImageFrame& images, int) {
  std::swap(images.left, *images.right);
}

std::unique_ptr<Recording> fitted(Calibration calibration, WallRecording::Change change = {}, int disparity = 12) {
  return with_fitting_pair(std::make_unique<WallRecording>(std::move(calibration), std::move(change), disparity),
                           "walk");
}

// Whether the left image of a frame is that of the left camera.
bool has_left_image(Recording& recording) {
  return recording.read(7)->left.pixels == texture(7, 0).pixels;
}

TEST(FittingPair, IsTheRecordingItselfAfterOneFrameThatFits) {
  auto recording = std::make_unique<WallRecording>(right_calibration());
  WallRecording* const given = recording.get();
  const std::unique_ptr<Recording> fitting = with_fitting_pair(std::move(recording), "walk");
  ASSERT_EQ(fitting.get(), given);
  EXPECT_EQ(given->reads, 1);
}

TEST(FittingPair, ExchangesImagesBack) {
  const auto recording = fitted(right_calibration(), exchange);
  EXPECT_TRUE(has_left_image(*recording));
  EXPECT_EQ(recording->calibration(), right_calibration());
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("walk: left and right images are exchanged; the images are "
                                                           "exchanged back, so that ")));
}

TEST(FittingPair, ExchangesCamerasAndImagesIfBothAreExchanged) {
  const auto recording = fitted(with_cameras_exchanged(right_calibration()), exchange);
  EXPECT_TRUE(has_left_image(*recording));
  EXPECT_EQ(recording->calibration().left, right_calibration().left);
  EXPECT_EQ(recording->calibration().right, right_calibration().right);
  EXPECT_LT(recording->calibration().body_from_left.translation.norm(), 1e-12);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("cameras and images are exchanged")));
}

TEST(FittingPair, ExchangesCamerasOfACalibrationInOtherOrderThanTheImages) {
  const auto recording = fitted(with_cameras_exchanged(right_calibration()));
  EXPECT_TRUE(has_left_image(*recording));
  EXPECT_EQ(recording->calibration().left, right_calibration().left);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("the cameras of the calibration are exchanged")));
}

TEST(FittingPair, ReversesABaselineOfTheWrongSign) {
  Calibration wrong = right_calibration();
  wrong.right->right_from_left.translation *= -1.0;
  const auto recording = fitted(wrong);
  EXPECT_TRUE(has_left_image(*recording));
  EXPECT_EQ(recording->calibration(), right_calibration());
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("the baseline is reversed")));
}

TEST(FittingPair, ReversesABaselineOfTheWrongSignAndExchangesCamerasAndImages) {
  Calibration wrong = with_cameras_exchanged(right_calibration());
  wrong.right->right_from_left.translation *= -1.0;
  const auto recording = fitted(wrong, exchange);
  EXPECT_TRUE(has_left_image(*recording));
  EXPECT_EQ(recording->calibration().left, right_calibration().left);
  EXPECT_EQ(recording->calibration().right, right_calibration().right);
}

TEST(FittingPair, InvertsInverseExtrinsics) {
  Calibration pair = right_calibration();
  pair.right->right_from_left.rotation = rotation_exp({0.0, 0.0, 0.02});
  Calibration wrong = pair;
  wrong.right->right_from_left = inverse(pair.right->right_from_left);
  const auto turn = [&](ImageFrame& images, int) {
    // Each pixel of the turned right camera shows that of the upright one in the same direction.
    const Image upright = *images.right;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const Eigen::Vector3d ray((u - 160.0) / kFocal, (v - 120.0 - kLower) / kFocal, 1.0);
        const Eigen::Vector3d turned = pair.right->right_from_left.rotation.conjugate() * ray;
        const int x = std::clamp(static_cast<int>(std::lround(kFocal * turned.x() + 160.0)), 0, kWidth - 1);
        const int y = std::clamp(static_cast<int>(std::lround(kFocal * turned.y() + 120.0 + kLower)), 0, kHeight - 1);
        images.right->pixels[static_cast<std::size_t>(v * kWidth + u)] =
            upright.pixels[static_cast<std::size_t>(y * kWidth + x)];
      }
    }
  };
  const auto recording = fitted(wrong, turn);
  EXPECT_LT(rotation_log(recording->calibration().right->right_from_left.rotation.conjugate() *
                         pair.right->right_from_left.rotation)
                .norm(),
            1e-12);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("the baseline is reversed")));
}

TEST(FittingPair, TurnsTheGyroscopeWithTheLeftCamera) {
  Calibration exchanged = with_cameras_exchanged(right_calibration());
  exchanged.body_from_left.rotation = rotation_exp({0.1, 0.2, 0.3});
  exchanged.right->right_from_left.rotation = rotation_exp({0.0, 0.0, 0.001});
  const auto recording = fitted(exchanged, exchange);
  ASSERT_FALSE(recording->warnings().empty());
  EXPECT_LT(recording->motion().left_from_gyroscope->angularDistance(exchanged.right->right_from_left.rotation), 1e-12);
}

struct WeakEvidence {
  std::string name;
  WallRecording::Change change;
  int disparity = 12;
};

class PairWithWeakEvidence : public testing::TestWithParam<WeakEvidence> {};

TEST_P(PairWithWeakEvidence, IsNotChanged) {
  const auto& [name, change, disparity] = GetParam();
  auto recording = std::make_unique<WallRecording>(right_calibration(), change, disparity);
  WallRecording* const given = recording.get();
  const std::unique_ptr<Recording> fitting = with_fitting_pair(std::move(recording), "walk");
  ASSERT_EQ(fitting.get(), given);
  EXPECT_EQ(given->reads, 10);
}

void blank(Image& image, int grey) {
  std::ranges::fill(image.pixels, static_cast<std::uint8_t>(grey));
}

INSTANTIATE_TEST_SUITE_P(
    FittingPair, PairWithWeakEvidence,
    testing::Values(WeakEvidence{"dark",
                                 [](ImageFrame& images, int index) {
                                   exchange(images, index);
                                   blank(images.left, 0);
                                   blank(*images.right, 0);
                                 }},
                    WeakEvidence{"covered_left_lens", [](ImageFrame& images, int) { blank(images.left, 12); }},
                    WeakEvidence{"covered_right_lens", [](ImageFrame& images, int) { blank(*images.right, 12); }},
                    WeakEvidence{"unsynchronised", [](ImageFrame& images,
                                                      int index) { images.right = texture(index + 1000, 12, kLower); }},
                    WeakEvidence{"two_frames_exchanged",
                                 [](ImageFrame& images, int index) {
                                   if (index < 10) return exchange(images, index);
                                   blank(images.left, 0);
                                   blank(*images.right, 0);
                                 }},
                    WeakEvidence{"mostly_unsynchronised",
                                 [](ImageFrame& images, int index) {
                                   exchange(images, index);
                                   if (index >= 25) images.right = texture(index + 1000, 0);
                                 }},
                    // A distant scene, and a right camera that is turned inwards by half a degree.
                    WeakEvidence{"distant", {}, -2}),
    [](const auto& test) { return test.param.name; });

TEST(FittingPair, ReportsFaultyFramesOnlyWhenTheyAreRead) {
  const auto recording = fitted(right_calibration(), [](ImageFrame& images, int index) {
    if (index < 5) images.right.reset();
  });
  EXPECT_THAT(recording->warnings(), IsEmpty());
  EXPECT_TRUE(has_left_image(*recording));
  recording->read(0);
  EXPECT_THAT(recording->warnings(), ElementsAre("no right image"));
}

TEST(FittingPair, OmitsFramesWithoutTheImageOfTheLeftCamera) {
  const auto recording = fitted(right_calibration(), [](ImageFrame& images, int index) {
    exchange(images, index);
    if (index == 1) images.right.reset();
  });
  ASSERT_EQ(recording->warnings().size(), 1U);
  EXPECT_FALSE(recording->read(1));
  EXPECT_EQ(recording->warnings().size(), 2U);
}

}  // namespace
}  // namespace byre
