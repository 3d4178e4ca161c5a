#include "byre/recording.h"

#include "byre/io/recording/folder_scene.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <sys/stat.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kSmallWidth = 32;
constexpr int kSmallHeight = 24;

std::string sensor_yaml(double x_in_body) {
  return "T_BS:\n  data: [1, 0, 0, " + std::to_string(x_in_body) +
         ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [32, 24]\ncamera_model: pinhole\n"
         "intrinsics: [20, 20, 15.5, 11.5]\ndistortion_model: radial-tangential\n"
         "distortion_coefficients: [0, 0, 0, 0]\n";
}

// Four stereo pairs, 100 ms apart, in EuRoC's layout: left images are 10, 20.. in grey, right images 15, 25..
class EurocRecording : public TestFolder {
 protected:
  EurocRecording() {
    write("mav0/cam0/sensor.yaml", sensor_yaml(0.1));
    write("mav0/cam1/sensor.yaml", sensor_yaml(0.3));
    write("mav0/cam0/data.csv", kCsv);
    write("mav0/cam1/data.csv", kCsv);
    for (int i = 1; i <= 4; ++i) {
      write_image("mav0/cam0/data/" + std::to_string(i) + ".png", kSmallWidth, kSmallHeight, 10 * i);
      write_image("mav0/cam1/data/" + std::to_string(i) + ".png", kSmallWidth, kSmallHeight, 10 * i + 5);
    }
  }

  std::unique_ptr<Recording> open(const FrameRange& range = {}) const { return open_recording(folder_, range); }
  std::string open_error(const FrameRange& range = {}) const {
    return error_of([&] { open(range); });
  }

  const std::string kCsv =
      "#timestamp [ns],filename\r\n100000000,1.png\r\n200000000, 2.png\r\n300000000 ,3.png\r\n400000000,4.png \r\n";
};

TEST_F(EurocRecording, ReturnsTimedPairs) {
  const std::unique_ptr<Recording> recording = open();
  EXPECT_THAT(recording->times(),
              ElementsAre(milliseconds(100), milliseconds(200), milliseconds(300), milliseconds(400)));
  const std::optional<ImageFrame> frame = recording->read(1);
  ASSERT_TRUE(frame && frame->right);
  EXPECT_EQ(frame->time, milliseconds(200));
  EXPECT_EQ(frame->left.width, kSmallWidth);
  EXPECT_EQ(frame->left.pixels.back(), 20);
  EXPECT_EQ(frame->right->pixels.back(), 25);
  EXPECT_THAT(recording->warnings(), IsEmpty());
}

TEST_F(EurocRecording, PlacesTheRightCamera) {
  const Calibration calibration = open()->calibration();
  ASSERT_TRUE(calibration.right.has_value());
  EXPECT_NEAR(calibration.right->right_from_left.translation.x(), -0.2, 1e-12);
  EXPECT_NEAR(calibration.body_from_left.translation.x(), 0.1, 1e-12);
}

TEST_F(EurocRecording, OpensTheInnerFolder) {
  EXPECT_EQ(open_recording(folder_ / "mav0", {})->size(), 4);
  EXPECT_EQ(guess_format(folder_ / "mav0"), RecordingFormat::euroc);
}

TEST_F(EurocRecording, IsMonocularWithoutTheSecondCamera) {
  fs::remove_all(folder_ / "mav0/cam1");
  const std::unique_ptr<Recording> recording = open();
  EXPECT_FALSE(recording->calibration().right.has_value());
  const std::optional<ImageFrame> frame = recording->read(0);
  ASSERT_TRUE(frame.has_value());
  EXPECT_FALSE(frame->right.has_value());
  EXPECT_THAT(recording->warnings(), IsEmpty());
}

TEST_F(EurocRecording, PairsImagesByTime) {
  write("mav0/cam1/data.csv", "201900000,2.png\n297000000,3.png\n400000000,4.png\n");
  const std::unique_ptr<Recording> recording = open();
  ASSERT_EQ(recording->size(), 4);
  EXPECT_FALSE(recording->read(0)->right.has_value());
  EXPECT_EQ(recording->read(1)->right->pixels.back(), 25);
  EXPECT_FALSE(recording->read(2)->right.has_value());
  EXPECT_EQ(recording->read(3)->right->pixels.back(), 45);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("1.png: has no right image"), HasSubstr("3.png: has no")));
}

TEST_F(EurocRecording, ContinuesAfterABadImage) {
  write("mav0/cam0/data/1.png", "broken");
  fs::remove(folder_ / "mav0/cam1/data/2.png");
  write_image("mav0/cam0/data/3.png", kSmallWidth, kSmallHeight + 1, 30);
  const std::unique_ptr<Recording> recording = open();
  EXPECT_FALSE(recording->read(0).has_value());
  EXPECT_FALSE(recording->read(1)->right.has_value());
  EXPECT_FALSE(recording->read(2).has_value());
  EXPECT_TRUE(recording->read(3)->right.has_value());
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("cam0/data/1.png: is not a complete image"),
                                                 HasSubstr("cam1/data/2.png: does not exist"),
                                                 HasSubstr("cam0/data/3.png: is 32x25 instead of 32x24")));
}

TEST_F(EurocRecording, SelectsARangeOfFrames) {
  EXPECT_THAT(open({.start_s = 0.1, .end_s = 0.3})->times(), ElementsAre(milliseconds(200), milliseconds(300)));
  EXPECT_THAT(open({.first = 1, .last = 3})->times(), ElementsAre(milliseconds(200), milliseconds(300)));
  EXPECT_THAT(open({.first = 1, .stride = 2})->times(), ElementsAre(milliseconds(200), milliseconds(400)));
  EXPECT_THAT(open({.start_s = 0.2, .last = 3})->times(), ElementsAre(milliseconds(300)));
  EXPECT_EQ(open({.first = 2})->read(0)->left.pixels.back(), 30);
}

TEST_F(EurocRecording, RejectsAnEmptyRange) {
  EXPECT_THAT(open_error({.first = 4}),
              HasSubstr("the selected range contains no frame (the recording has 4 frames in 0.3"));
  EXPECT_THAT(open_error({.start_s = 0.2, .end_s = 0.2}), HasSubstr("the selected range contains no frame"));
  EXPECT_THAT(open_error({.stride = 0}), HasSubstr("stride"));
}

TEST_F(EurocRecording, ReportsTheMissingFile) {
  fs::remove(folder_ / "mav0/cam1/data.csv");
  EXPECT_THAT(open_error(), HasSubstr("cam1/data.csv: cannot be opened"));
  fs::remove(folder_ / "mav0/cam0/sensor.yaml");
  EXPECT_THAT(open_error(), HasSubstr("cam0/sensor.yaml: cannot be opened"));
}

TEST_F(EurocRecording, ReportsTheInvalidLineOfAList) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"100,1.png\n100,2.png\n", "data.csv: all of its 2 images have the same time stamp"},
      {"100,1.png\n0.2,2.png\n", "data.csv:2: \"0.2\" is not a time in nanoseconds"},
      {"100\n", "data.csv:1: has no name of an image file"},
      {"100,\n", "data.csv:1: has no name of an image file"},
      {"#timestamp\n", "data.csv: lists no images"},
  };
  for (const auto& [csv, message] : cases) {
    write("mav0/cam0/data.csv", csv);
    EXPECT_THAT(open_error(), HasSubstr(message));
  }
}

TEST_F(EurocRecording, SortsAndCountsLateLines) {
  write("mav0/cam0/data.csv",
        "#\n100000000,1.png\n300000000,3.png\n200000000,2.png\n200000000,2.png\n400000000,4.png\n");
  const auto recording = open();
  EXPECT_THAT(recording->times(),
              ElementsAre(milliseconds(100), milliseconds(200), milliseconds(300), milliseconds(400)));
  EXPECT_EQ(recording->time_corrections().late, 1);
  EXPECT_EQ(recording->time_corrections().repeated, 1);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("1 images were recorded after later ones: sorted by time"),
                                                 HasSubstr("1 images have the time stamp of another one")));
}

// Twelve pairs, 100 ms apart, with a clock that is set back by 350 ms before the seventh. Wheels and gyroscope share
// the clock.
class EurocWithClockStep : public EurocRecording {
 protected:
  EurocWithClockStep() {
    const auto stamp = [](int ms) { return std::to_string(1'000'000 + ms - (ms >= 580 ? 350 : 0)); };
    std::string images, wheels, imu;
    for (int i = 0; i < 12; ++i) images += stamp(100 * i) + "000000," + std::to_string(i % 4 + 1) + ".png\n";
    for (int i = 0; i < 60; ++i) {
      const std::string ms = stamp(20 * i);
      wheels += ms.substr(0, 4) + "." + ms.substr(4) + " " + std::to_string(i) + " 0 0 0 0 0 1\n";
      imu += ms + "000000,0,0," + std::to_string(i) + "\n";
    }
    write("mav0/cam0/data.csv", images);
    write("mav0/cam1/data.csv", images);
    write("wheel.txt", wheels);
    write("mav0/imu0/data.csv", imu);
  }
};

TEST_F(EurocWithClockStep, ContinuesWithSynchronisedWheelsAndGyroscope) {
  const auto recording = open_recording(folder_, {}, {.use_gyroscope = true});
  ASSERT_EQ(recording->size(), 12);
  ASSERT_THAT(recording->time_corrections().clock_steps, SizeIs(1));
  EXPECT_EQ(recording->time_corrections().clock_steps[0].frame, 6);
  EXPECT_EQ(recording->time_corrections().clock_steps[0].by, milliseconds(-350));
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(recording->times()[static_cast<std::size_t>(i)], milliseconds(1'000'000 + 100 * i));
    EXPECT_TRUE(recording->read(i)->right.has_value()) << i;
  }
  ASSERT_THAT(recording->motion().wheels, SizeIs(60));
  for (const StampedPose& sample : recording->motion().wheels) {
    EXPECT_EQ(sample.time, milliseconds(1'000'000 + 20 * std::lround(sample.world_from_body.translation.x())));
  }
  ASSERT_THAT(recording->motion().rates, SizeIs(60));
  for (const AngularRate& sample : recording->motion().rates) {
    EXPECT_EQ(sample.time, milliseconds(1'000'000 + 20 * std::lround(sample.rate.z())));
  }
  EXPECT_THAT(recording->warnings(),
              testing::Contains(HasSubstr("cam0/data.csv: clock set back by 0.350 s at frame 6")));
  EXPECT_THAT(recording->warnings(), testing::Contains(HasSubstr("wheel.txt: clock set back by 0.350 s at line 29")));
}

TEST_F(EurocRecording, PairsImagesWithinTheTolerance) {
  write("mav0/cam1/data.csv", "108000000,1.png\n208000000,2.png\n308000000,3.png\n408000000,4.png\n");
  EXPECT_THAT(open_error(),
              HasSubstr("no right image is within 2 ms of a left image; the median difference is 8.000 "
                        "ms (trigger both cameras together; if the images are pairs, accept the difference "
                        "with --pair-tolerance 0.009;"));
  EXPECT_TRUE(open_recording(folder_, {}, {.pair_tolerance_s = 0.009})->read(0)->right.has_value());
}

TEST_F(EurocRecording, RejectsACalibrationForAnotherImageSize) {
  for (int i = 1; i <= 4; ++i) write_image("mav0/cam1/data/" + std::to_string(i) + ".png", 16, 12, 50);
  EXPECT_THAT(open_error(), HasSubstr("cam1/sensor.yaml: resolution: is 32x24, but the images are 16x12"));
}

TEST_F(EurocRecording, RejectsCamerasAtTheSamePosition) {
  write("mav0/cam1/sensor.yaml", sensor_yaml(0.1));
  EXPECT_THAT(open_error(), HasSubstr("cam1/sensor.yaml: T_BS: places both cameras at the same position"));
}

TEST_F(EurocRecording, RejectsCamerasOnDifferentClocks) {
  write("mav0/cam1/data.csv", "1100000000,1.png\n1200000000,2.png\n");
  EXPECT_THAT(open_error(), HasSubstr("cam1/data.csv: no right image is within 2 ms"));
}

TEST_F(EurocRecording, RejectsAFolderWithoutReadableImages) {
  fs::remove_all(folder_ / "mav0/cam0/data");
  EXPECT_THAT(open_error(), HasSubstr("cam0/data: no listed image can be read: 1.png "));
}

TEST_F(EurocRecording, OpensAtARangeWithoutReadableImages) {
  fs::remove(folder_ / "mav0/cam0/data/1.png");
  fs::remove(folder_ / "mav0/cam1/data/2.png");
  const std::unique_ptr<Recording> recording = open({.last = 2});
  EXPECT_FALSE(recording->read(0).has_value());
  EXPECT_FALSE(recording->read(1)->right.has_value());
  EXPECT_FALSE(open({.last = 1})->read(0).has_value());
  EXPECT_FALSE(open({.first = 1, .last = 2})->read(0)->right.has_value());
}

TEST_F(EurocRecording, FindsItsGroundTruth) {
  EXPECT_FALSE(find_ground_truth(folder_).has_value());
  write("mav0/state_groundtruth_estimate0/data.csv", "");
  EXPECT_EQ(find_ground_truth(folder_), folder_ / "mav0/state_groundtruth_estimate0/data.csv");
}

constexpr const char* kCalib =
    "P0: 20 0 15.5 0 0 20 11.5 0 0 0 1 0\nP1: 20 0 15.5 -10 0 20 11.5 0 0 0 1 0\nTr: 1 0 0 0 0 1 0 0 0 0 1 0\n";

TEST_F(EurocRecording, RejectsABaselineInCentimetresUnlessCorrectedOrConfirmed) {
  write("mav0/cam1/sensor.yaml", sensor_yaml(7.6));
  EXPECT_THAT(open_error(), testing::AllOf(HasSubstr(folder_.string()), HasSubstr("baseline of 7.5 m"),
                                           HasSubstr("--baseline 0.075")));
  OpenOptions options;
  for (const double baseline : {0.075, 7.5}) {
    options.baseline = baseline;
    const Calibration calibration = open_recording(folder_, {}, options)->calibration();
    EXPECT_NEAR(calibration.right->right_from_left.translation.norm(), baseline, 1e-9);
  }
  options = {};
  options.camera = CameraChoice::left;
  EXPECT_FALSE(open_recording(folder_, {}, options)->calibration().right);
}

// Three stereo pairs, 100 ms apart, in the layout of KITTI odometry.
class KittiRecording : public TestFolder {
 protected:
  KittiRecording() {
    write("sequences/07/calib.txt", kCalib);
    write("sequences/07/times.txt", "0.000000e+00\n1.000000e-01\n2.000000e-01\n");
    for (int i = 0; i < 3; ++i) {
      write_image("sequences/07/image_0/00000" + std::to_string(i) + ".png", kSmallWidth, kSmallHeight, 10 * i + 10);
      write_image("sequences/07/image_1/00000" + std::to_string(i) + ".png", kSmallWidth, kSmallHeight, 10 * i + 15);
    }
  }

  std::unique_ptr<Recording> open() const { return open_recording(sequence_, {}); }
  std::string open_error() const {
    return error_of([&] { open(); });
  }

  fs::path sequence_ = folder_ / "sequences" / "07";
};

TEST_F(KittiRecording, ReturnsRectifiedPairsInTheLeftCameraFrame) {
  const std::unique_ptr<Recording> recording = open();
  const Calibration& calibration = recording->calibration();
  EXPECT_EQ(calibration.left.model, CameraModel::pinhole);
  EXPECT_EQ(calibration.left.width, kSmallWidth);
  EXPECT_EQ(calibration.left.fx, 20.0);
  EXPECT_EQ(calibration.left.cy, 11.5);
  ASSERT_TRUE(calibration.right.has_value());
  EXPECT_EQ(calibration.right->right_from_left.translation, Eigen::Vector3d(-0.5, 0.0, 0.0));
  EXPECT_TRUE(calibration.body_from_left.translation.isZero());
  const std::optional<ImageFrame> frame = recording->read(2);
  ASSERT_TRUE(frame && frame->right);
  EXPECT_EQ(frame->time, milliseconds(200));
  EXPECT_EQ(frame->left.pixels.back(), 30);
  EXPECT_EQ(frame->right->pixels.back(), 35);
}

TEST_F(KittiRecording, IsMonocularWithoutTheSecondCamera) {
  fs::remove_all(sequence_ / "image_1");
  write("sequences/07/calib.txt", "P0: 20 0 15.5 0 0 20 11.5 0 0 0 1 0\n");
  EXPECT_FALSE(open()->calibration().right.has_value());
}

TEST_F(KittiRecording, ReportsInvalidCalibrations) {
  const std::string p0 = "P0: 20 0 15.5 0 0 20 11.5 0 0 0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"P1: 20 0 15.5 0 0 20 11.5 0 0 0 1 0\n", "calib.txt: P0: is missing"},
      {p0, "calib.txt: P1: is missing"},
      {"P0: 20 0 15.5 0 0 20 11.5 0 0 0 1\n", "calib.txt: P0: does not have twelve numbers"},
      {"P0: 20 0 x 0 0 20 11.5 0 0 0 1 0\n", "calib.txt: P0: contains a value that is not a number"},
      {"P0: -20 0 15.5 0 0 20 11.5 0 0 0 1 0\n", "calib.txt: P0: the focal lengths must be positive"},
      {"P0: 20 1 15.5 0 0 20 11.5 0 0 0 1 0\n", "calib.txt: P0: is not the projection matrix of a rectified camera"},
      {"P0: 20 0 155 0 0 20 11.5 0 0 0 1 0\n", "calib.txt: P0: the principal point is outside"},
      {p0 + "P1: 20 0 15.5 10 0 20 11.5 0 0 0 1 0\n", "calib.txt: P1: does not place the right camera to the right"},
  };
  for (const auto& [calib, message] : cases) {
    write("sequences/07/calib.txt", calib);
    EXPECT_THAT(open_error(), HasSubstr(message)) << calib;
  }
}

TEST_F(KittiRecording, ReportsMissingFilesAndUnsortedTimes) {
  write("sequences/07/times.txt", "0\n0.1\nsoon\n");
  EXPECT_THAT(open_error(), HasSubstr("times.txt:3: \"soon\" is not a time in seconds"));
  fs::remove(sequence_ / "times.txt");
  EXPECT_THAT(open_error(), HasSubstr("times.txt: cannot be opened"));
}

TEST_F(KittiRecording, KeepsTheImageOrder) {
  write("sequences/07/times.txt", "0\n0.2\n0.1\n");
  const auto recording = open();
  EXPECT_THAT(recording->times(), ElementsAre(milliseconds(0), milliseconds(200), milliseconds(400)));
  EXPECT_EQ(recording->read(2)->left.pixels.back(), 30);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("1 images have a zero or wrong time stamp")));
}

TEST_F(KittiRecording, CountsImagesWithoutTimes) {
  write("sequences/07/times.txt", "0\n0.1\n");
  EXPECT_THAT(open()->warnings(), ElementsAre(HasSubstr("has 2 times for 3 images: the last 1 are ignored")));
}

TEST_F(KittiRecording, FindsItsGroundTruth) {
  EXPECT_FALSE(find_ground_truth(sequence_).has_value());
  write("poses/07.txt", "");
  ASSERT_TRUE(find_ground_truth(sequence_).has_value());
  EXPECT_TRUE(fs::equivalent(*find_ground_truth(sequence_), folder_ / "poses" / "07.txt"));
}

using GuessFormat = TestFolder;

TEST_F(GuessFormat, ReportsTheSupportedFormats) {
  EXPECT_THAT(error_of([&] { guess_format(folder_); }), HasSubstr("supported: mav0/cam0"));
  EXPECT_THAT(error_of([&] { guess_format(folder_ / "absent"); }), HasSubstr("absent: is not a folder"));
}

class RealRecording : public testing::Test {
 protected:
  static fs::path data() {
    const char* const folder = std::getenv("BYRE_DATA");
    return folder != nullptr ? fs::path(folder) : fs::path(BYRE_SOURCE_DIR) / ".." / "shared" / "data";
  }
};

TEST_F(RealRecording, ReadsEuroc) {
  const fs::path folder = data() / "euroc" / "MH_01_easy";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent; set BYRE_DATA";
  const std::unique_ptr<Recording> recording = open_recording(folder, {});
  EXPECT_EQ(recording->size(), 300);
  EXPECT_EQ(recording->calibration().left.model, CameraModel::radial_tangential);
  EXPECT_NEAR(recording->calibration().right->right_from_left.translation.norm(), 0.110, 0.001);
  const std::optional<ImageFrame> frame = recording->read(299);
  ASSERT_TRUE(frame && frame->right);
  EXPECT_EQ(frame->right->width, 752);
  EXPECT_TRUE(find_ground_truth(folder).has_value());
}

TEST_F(RealRecording, ReadsEurocInJpeg) {
  const fs::path folder = data() / "euroc" / "V1_01_easy_sparse";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent; set BYRE_DATA";
  const std::unique_ptr<Recording> recording = open_recording(folder, {});
  EXPECT_EQ(recording->size(), 100);
  for (int i = 0; i < recording->size(); i += 25) EXPECT_TRUE(recording->read(i)->right.has_value());
  EXPECT_THAT(recording->warnings(), IsEmpty());
}

TEST_F(RealRecording, ReadsKitti) {
  const fs::path folder = data() / "kitti" / "sequences" / "00";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent; set BYRE_DATA";
  const std::unique_ptr<Recording> recording = open_recording(folder, {});
  EXPECT_EQ(recording->size(), 60);
  EXPECT_NEAR(recording->calibration().right->right_from_left.translation.x(), -0.537, 0.001);
  EXPECT_EQ(recording->read(59)->left.width, 1241);
  EXPECT_TRUE(find_ground_truth(folder).has_value());
}

TEST_F(EurocRecording, DoesNotBlockOnPipesInItsFolders) {
  for (const char* const name : {"mav0/cam0/data.csv", "mav0/cam0/sensor.yaml"}) {
    fs::rename(folder_ / name, folder_ / "kept");
    ASSERT_EQ(mkfifo((folder_ / name).c_str(), 0600), 0);
    EXPECT_THAT(open_error(), HasSubstr(std::string(name) + ": is a pipe or a device, not a file"));
    fs::remove(folder_ / name);
    fs::rename(folder_ / "kept", folder_ / name);
  }
}

}  // namespace
}  // namespace byre
