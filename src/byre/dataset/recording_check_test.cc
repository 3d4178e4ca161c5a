#include "byre/dataset/recording_check.h"

#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 320, kHeight = 240, kDisparity = 8;

// Squares of any brightness, which lie elsewhere in each frame.
Image texture(int frame, int shift) {
  Image image{kWidth, kHeight, std::vector<std::uint8_t>(static_cast<std::size_t>(kWidth * kHeight), 128)};
  std::mt19937 random(static_cast<unsigned>(frame));
  for (int square = 0; square < 700; ++square) {
    const int u = static_cast<int>(random() % (kWidth + 40)) - 20, v = static_cast<int>(random() % kHeight);
    const int side = 3 + static_cast<int>(random() % 12);
    const auto grey = static_cast<std::uint8_t>(40 + random() % 180);
    for (int y = v; y < std::min(v + side, kHeight); ++y) {
      for (int x = std::max(0, u - shift); x < std::min(u + side - shift, kWidth); ++x) {
        image.pixels[static_cast<std::size_t>(y * kWidth + x)] = grey;
      }
    }
  }
  return image;
}

// A pair that sees a wall, ten frames a second, and what is done to its images.
class MadeUpRecording : public Recording {
 public:
  using Change = std::function<void(ImageFrame& images, int index)>;

  explicit MadeUpRecording(Change change = {}) : change_(std::move(change)) {
    Camera camera;
    camera.width = kWidth;
    camera.height = kHeight;
    camera.fx = camera.fy = 250.0;
    camera.cx = 160.0;
    camera.cy = 120.0;
    calibration_.left = camera;
    Pose right_from_left;
    right_from_left.translation.x() = -0.1;
    calibration_.right = StereoPartner{camera, right_from_left};
    for (int i = 0; i < 40; ++i) times_.push_back(from_seconds(0.1 * i + (i >= 20 ? 2.0 : 0.0)));
  }

  const Calibration& calibration() const override { return calibration_; }
  const std::vector<Timestamp>& times() const override { return times_; }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  const MotionSamples& motion() const override { return motion_; }
  void set_motion(MotionSamples samples) { motion_ = std::move(samples); }
  std::optional<ImageFrame> read(int index) override {
    ImageFrame images{times_[static_cast<std::size_t>(index)], texture(index, 0), texture(index, kDisparity)};
    if (change_) change_(images, index);
    return images;
  }

 private:
  Change change_;
  MotionSamples motion_;
  Calibration calibration_;
  std::vector<Timestamp> times_;
  std::vector<std::string> warnings_;
};

RecordingCheck check_of(const MadeUpRecording::Change& change = {}) {
  MadeUpRecording recording(change);
  return check_recording(recording, 5);
}

std::string grave_findings(const RecordingCheck& check) {
  std::string text;
  for (const Finding& finding : findings_of(check)) text += finding.is_grave ? finding.what + "\n" : "";
  return text;
}

TEST(RecordingCheck, OfASoundPairMeasuresWhatItIs) {
  const RecordingCheck check = check_of();
  EXPECT_EQ(check.frames, 40);
  EXPECT_NEAR(check.rate_hz, 10.0, 1e-6);
  EXPECT_EQ(check.gaps, 1);
  EXPECT_NEAR(check.longest_gap_s, 2.1, 1e-6);
  EXPECT_EQ(check.looked_at, 10);
  EXPECT_EQ(check.repeated, 0);
  EXPECT_NEAR(check.baseline_m, 0.1, 1e-9);
  EXPECT_NEAR(check.field_of_view_deg, 65.2, 0.1);
  ASSERT_TRUE(check.pair);
  EXPECT_GT(check.pair->matched, 0.4);
  EXPECT_LT(check.pair->row_error, 0.3);
  EXPECT_THAT(grave_findings(check), IsEmpty());
}

TEST(RecordingCheck, FindsACameraThatRepeatsItsImage) {
  const RecordingCheck check = check_of([](ImageFrame& images, int) { images.left = texture(0, 0); });
  EXPECT_EQ(check.repeated, 5);
  EXPECT_THAT(grave_findings(check), HasSubstr("same as the one before"));
}

TEST(RecordingCheck, FindsSwappedCameras) {
  const RecordingCheck check = check_of([](ImageFrame& images, int) { std::swap(images.left, *images.right); });
  EXPECT_THAT(grave_findings(check), HasSubstr("found in the right image"));
}

TEST(RecordingCheck, FindsACameraThatWasMovedByItsRows) {
  const RecordingCheck check = check_of([](ImageFrame& images, int) {
    std::vector<std::uint8_t>& pixels = images.right->pixels;
    std::shift_right(pixels.begin(), pixels.end(), kWidth);  // by a row
  });
  ASSERT_TRUE(check.pair);
  EXPECT_NEAR(check.pair->calibration_error, 1.0, 0.2);
  EXPECT_THAT(grave_findings(check), HasSubstr("off their row"));
}

TEST(RecordingCheck, FindsADarkCameraAndDoesNotBlameThePairForIt) {
  const RecordingCheck check =
      check_of([](ImageFrame& images, int) { images.right->pixels.assign(images.right->pixels.size(), 0); });
  EXPECT_THAT(grave_findings(check), HasSubstr("right images are dark"));
  EXPECT_THAT(grave_findings(check), Not(HasSubstr("found in the right image")));
}

TEST(RecordingCheck, TellsOfFramesWithoutARightImageAndOfFramesThatCannotBeRead) {
  const RecordingCheck check = check_of([](ImageFrame& images, int index) {
    if (index % 2 == 1) images.right.reset();
  });
  EXPECT_GT(check.without_right, 0);
  EXPECT_THAT(grave_findings(check), IsEmpty());
}

TEST(RecordingCheck, SaysWhatToDoAboutEachThing) {
  RecordingCheck check = check_of();
  check.rate_hz = 2.0;
  check.field_of_view_deg = 3.0;
  check.baseline_m = 5.0;
  check.features = 20.0;
  const std::vector<Finding> findings = findings_of(check);
  EXPECT_GE(findings.size(), 4u);
  for (const Finding& finding : findings) EXPECT_FALSE(finding.remedy.empty()) << finding.what;
}

TEST(MotionFindings, NameFileFaultAndRemedy) {
  MadeUpRecording recording;
  const auto source_of = [](MotionSensor sensor) {
    return sensor == MotionSensor::wheels ? "walk/wheel.txt" : "walk/imu.csv";
  };
  EXPECT_THAT(motion_findings(recording, source_of), IsEmpty());
  MotionSamples samples;
  for (int i = 0; i < 300; ++i) {
    const double seconds = 0.02 * i;
    samples.wheels.push_back({from_seconds(seconds), {Eigen::Quaterniond::Identity(), {50.0 * seconds, 0.0, 0.0}}});
    samples.accelerations.push_back({from_seconds(seconds), {0.0, 0.0, 1.0}});
  }
  recording.set_motion(samples);
  const std::vector<Finding> findings = motion_findings(recording, source_of);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_THAT(findings[0].what, HasSubstr("wheels (walk/wheel.txt), at "));
  EXPECT_THAT(findings[0].remedy, HasSubstr("centimetres"));
  EXPECT_THAT(findings[1].what, HasSubstr("accelerometer (walk/imu.csv)"));
  EXPECT_THAT(findings[1].remedy, HasSubstr("multiples of g"));
}

}  // namespace
}  // namespace byre
