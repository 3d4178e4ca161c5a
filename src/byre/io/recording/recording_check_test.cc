#include "byre/io/recording/recording_check.h"

#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 320, kHeight = 240, kDisparity = 8;

// Squares of random brightness, at different positions in each frame.
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

// A stereo pair in front of a wall, at ten frames a second, with modified images.
class SyntheticRecording : public Recording {
 public:
  using Change = std::function<void(ImageFrame& images, int index)>;

  explicit SyntheticRecording(Change change = {}) : change_(std::move(change)) {
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

RecordingCheck check_of(const SyntheticRecording::Change& change = {}) {
  SyntheticRecording recording(change);
  return check_recording(recording, 5);
}

std::string critical_findings(const RecordingCheck& check) {
  std::string text;
  for (const Finding& finding : findings_of(check)) text += finding.is_critical ? finding.what + "\n" : "";
  return text;
}

TEST(RecordingCheck, MeasuresASoundPair) {
  const RecordingCheck check = check_of();
  EXPECT_EQ(check.frames, 40);
  EXPECT_NEAR(check.rate_hz, 10.0, 1e-6);
  EXPECT_EQ(check.gaps, 1);
  EXPECT_NEAR(check.longest_gap_s, 2.1, 1e-6);
  EXPECT_EQ(check.sampled, 10);
  EXPECT_EQ(check.repeated, 0);
  EXPECT_NEAR(check.baseline_m, 0.1, 1e-9);
  EXPECT_NEAR(check.field_of_view_deg, 65.2, 0.1);
  ASSERT_TRUE(check.pair);
  EXPECT_GT(check.pair->matched, 0.4);
  EXPECT_LT(check.pair->row_error, 0.3);
  EXPECT_THAT(critical_findings(check), IsEmpty());
}

TEST(RecordingCheck, DetectsRepeatedImages) {
  const RecordingCheck check = check_of([](ImageFrame& images, int) { images.left = texture(0, 0); });
  EXPECT_EQ(check.repeated, 5);
  EXPECT_THAT(critical_findings(check), HasSubstr("identical to the previous one"));
}

TEST(RecordingCheck, DetectsSwappedCameras) {
  const RecordingCheck check = check_of([](ImageFrame& images, int) { std::swap(images.left, *images.right); });
  EXPECT_THAT(critical_findings(check), HasSubstr("match in the right image"));
}

TEST(RecordingCheck, DetectsAMovedCameraByRows) {
  const RecordingCheck check = check_of([](ImageFrame& images, int) {
    std::vector<std::uint8_t>& pixels = images.right->pixels;
    std::shift_right(pixels.begin(), pixels.end(), kWidth);  // shifts by a row
  });
  ASSERT_TRUE(check.pair);
  EXPECT_NEAR(check.pair->calibration_error, 1.0, 0.2);
  EXPECT_THAT(critical_findings(check), HasSubstr("off their row"));
}

TEST(RecordingCheck, DetectsADarkCameraWithoutBlamingThePair) {
  const RecordingCheck check =
      check_of([](ImageFrame& images, int) { images.right->pixels.assign(images.right->pixels.size(), 0); });
  EXPECT_THAT(critical_findings(check), HasSubstr("right images are dark"));
  EXPECT_THAT(critical_findings(check), Not(HasSubstr("match in the right image")));
}

TEST(RecordingCheck, ReportsMissingRightImagesAndUnreadableFrames) {
  const RecordingCheck check = check_of([](ImageFrame& images, int index) {
    if (index % 2 == 1) images.right.reset();
  });
  EXPECT_GT(check.without_right, 0);
  EXPECT_THAT(critical_findings(check), IsEmpty());
}

// A check without findings.
RecordingCheck sound_check() {
  RecordingCheck check;
  check.frames = check.sampled = 100;
  check.rate_hz = 10.0;
  check.features = 900.0;
  check.left.images = 100;
  check.left.by_fault[0] = 100;
  check.right = check.left;
  check.pair = PairCheck{.pairs = 100, .matched = 0.6, .best_match_rate = 0.9, .row_error = 0.2};
  check.field_of_view_deg = 80.0;
  check.baseline_m = 0.1;
  return check;
}

struct FindingCase {
  std::function<void(RecordingCheck&)> change;
  bool is_critical;
  std::string what;
};

class RecordingFinding : public testing::TestWithParam<FindingCase> {};

TEST_P(RecordingFinding, HasFiguresAndARemedy) {
  RecordingCheck check = sound_check();
  GetParam().change(check);
  const std::vector<Finding> findings = findings_of(check);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].what, GetParam().what);
  EXPECT_EQ(findings[0].is_critical, GetParam().is_critical);
  EXPECT_FALSE(findings[0].remedy.empty());
}

// Sets the number of images with a fault.
void set_fault(CameraCheck& camera, ImageFault fault, int images) {
  camera.by_fault[static_cast<std::size_t>(fault)] = images;
  camera.by_fault[0] -= images;
}

INSTANTIATE_TEST_SUITE_P(
    RecordingCheck, RecordingFinding,
    testing::Values(
        FindingCase{[](RecordingCheck& check) { check.rate_hz = 2.04; }, false, "frame rate of only 2.0 Hz"},
        FindingCase{[](RecordingCheck& check) {
                      check.gaps = 5;
                      check.longest_gap_s = 1.234;
                    },
                    false, "5 gaps between frames, the longest 1.23 s"},
        FindingCase{[](RecordingCheck& check) { check.unreadable = 3; }, false,
                    "3 of the checked images cannot be read"},
        FindingCase{[](RecordingCheck& check) { check.unreadable = 12; }, true,
                    "12 of the checked images cannot be read"},
        FindingCase{[](RecordingCheck& check) { check.repeated = 6; }, true,
                    "6 images are identical to the previous one, bit by bit"},
        FindingCase{[](RecordingCheck& check) { set_fault(check.left, ImageFault::dark, 51); }, true,
                    "51 of 100 left images are dark"},
        FindingCase{[](RecordingCheck& check) { set_fault(*check.right, ImageFault::overexposed, 6); }, false,
                    "6 of 100 right images are overexposed"},
        FindingCase{[](RecordingCheck& check) { set_fault(*check.right, ImageFault::flat, 7); }, false,
                    "7 of 100 right images are flat"},
        FindingCase{[](RecordingCheck& check) {
                      check.right.reset();
                      check.pair.reset();
                      check.baseline_m = 0.0;
                      set_fault(check.left, ImageFault::blurred, 8);
                    },
                    false, "8 of 100 images are blurred"},
        FindingCase{[](RecordingCheck& check) { check.without_right = 9; }, false, "9 frames have no right image"},
        FindingCase{[](RecordingCheck& check) {
                      check.pair->matched = 0.101;
                      check.pair->best_match_rate = 0.34;
                    },
                    false, "only 10.1 % of the features match in the right image, but 34 % in parts of it"},
        FindingCase{[](RecordingCheck& check) {
                      check.pair->matched = 0.011;
                      check.pair->best_match_rate = 0.02;
                    },
                    true, "only 1.1 % of the features match in the right image"},
        FindingCase{[](RecordingCheck& check) { check.pair->row_error = 1.234; }, true,
                    "features of the right image are 1.23 px off their row"},
        FindingCase{[](RecordingCheck& check) { check.pair->calibration_error = 0.62; }, false,
                    "the calibration error is about 0.62 px"},
        FindingCase{[](RecordingCheck& check) { check.field_of_view_deg = 3.4; }, false,
                    "a field of view of 3 degrees"},
        FindingCase{[](RecordingCheck& check) { check.features = 20.4; }, false, "only 20 features per image"}));

TEST(RecordingCheck, HasNoFindingsForSoundRecordings) {
  EXPECT_TRUE(findings_of(sound_check()).empty());
}

TEST(RecordingCheck, ListsSevereFindingsFirst) {
  RecordingCheck check = sound_check();
  check.rate_hz = 2.0;
  check.repeated = 50;
  const std::vector<Finding> findings = findings_of(check);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_TRUE(findings[0].is_critical);
  EXPECT_FALSE(findings[1].is_critical);
}

TEST(RecordingCheck, ReportsTimeCorrectionsWithARemedy) {
  RecordingCheck check = check_of();
  const auto findings_with = [&](const TimeCorrections& times) {
    check.times = times;
    std::string text;
    for (const Finding& finding : findings_of(check)) text += finding.what + ": " + finding.remedy + "\n";
    return text;
  };
  EXPECT_THAT(findings_with({.clock_steps = {{70, std::chrono::milliseconds(-620)}}}),
              HasSubstr("the image clock was set 1 time while recording, first by -0.620 s at frame 70; times "
                        "after it are shifted: set clocks before recording"));
  EXPECT_THAT(findings_with({.source = TimeSource::receive_times}), HasSubstr("receive times are used"));
  EXPECT_THAT(findings_with({.source = TimeSource::even_spacing}), HasSubstr("spread evenly"));
  EXPECT_THAT(findings_with({.unstamped = 3}), HasSubstr("3 images have a zero or wrong time stamp"));
  EXPECT_THAT(findings_with({.late = 2}), HasSubstr("2 images were recorded after later ones"));
  EXPECT_THAT(findings_with({.repeated = 4}), HasSubstr("4 images have the time stamp of another image"));
}

TEST(MotionFindings, ReportFileFaultAndRemedy) {
  SyntheticRecording recording;
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
