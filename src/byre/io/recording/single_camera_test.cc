// Recordings of one camera: one of a pair, TUM RGB-D folders, folders of images, videos.

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/recording/folder_scene.h"
#include "byre/recording.h"

#include <gmock/gmock.h>
#include <opencv2/videoio.hpp>

namespace byre {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string camera_yaml(const std::string& name, const std::string& more = "") {
  return name +
         ":\n  camera_model: pinhole\n  distortion_model: none\n  resolution: [32, 24]\n  intrinsics: [20, 20, " +
         (name == "cam0" ? "15.5" : "16.5") + ", 11.5]\n" + more;
}

// The right camera is 0.2 m to the right, and the body 0.1 m to the left of the left camera.
const std::string kPair =
    camera_yaml("cam0", "  T_cam_imu: [[1, 0, 0, -0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n") +
    camera_yaml("cam1", "  T_cn_cnm1: [[1, 0, 0, -0.2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n");
const std::string kOne = camera_yaml("cam0");

class SingleCamera : public TestFolder {
 protected:
  void write_frame(const std::string& name, int grey) const { write_image(name, 32, 24, grey); }

  std::unique_ptr<Recording> open(const OpenOptions& options = {}, const FrameRange& range = {}) const {
    return open_recording(folder_, range, options);
  }
  std::string open_error(const OpenOptions& options = {}, const FrameRange& range = {}) const {
    return error_of([&] { open(options, range); });
  }
  fs::path calibration(const std::string& content) const {
    write("given/cameras.yaml", content);
    return folder_ / "given/cameras.yaml";
  }
};

std::vector<int> greys_of(Recording& recording) {
  std::vector<int> greys;
  for (int i = 0; i < recording.size(); ++i) {
    const std::optional<ImageFrame> frame = recording.read(i);
    greys.push_back(frame ? frame->left.pixels.back() : -1);
  }
  return greys;
}

// Three frames of an EuRoC recording without sensor files; the second has no right image.
class SingleCameraOfPair : public SingleCamera {
 protected:
  SingleCameraOfPair() {
    write("mav0/cam0/data.csv", "100000000,1.png\n200000000,2.png\n300000000,3.png\n");
    write("mav0/cam1/data.csv", "100000000,1.png\n300000000,3.png\n");
    for (int i = 1; i <= 3; ++i) {
      write_frame("mav0/cam0/data/" + std::to_string(i) + ".png", 10 * i);
      write_frame("mav0/cam1/data/" + std::to_string(i) + ".png", 10 * i + 5);
    }
  }

  OpenOptions options(std::optional<CameraChoice> camera) const { return {camera, calibration(kPair)}; }
};

TEST_F(SingleCameraOfPair, OpensBothByDefault) {
  const OpenOptions both = options({});
  const auto recording = open(both);
  EXPECT_TRUE(recording->calibration().right);
  EXPECT_TRUE(recording->read(0)->right);
  EXPECT_EQ(camera_of(*recording, both), CameraChoice::stereo);
  EXPECT_TRUE(open(options(CameraChoice::stereo))->calibration().right);
}

TEST_F(SingleCameraOfPair, OpensTheLeftAlone) {
  fs::remove_all(folder_ / "mav0/cam1/data");
  const auto recording = open(options(CameraChoice::left));
  EXPECT_FALSE(recording->calibration().right);
  EXPECT_EQ(recording->calibration().left.cx, 15.5);
  EXPECT_NEAR(recording->calibration().body_from_left.translation.x(), 0.1, 1e-12);
  EXPECT_THAT(greys_of(*recording), ElementsAre(10, 20, 30));
  EXPECT_FALSE(recording->read(0)->right);
  EXPECT_THAT(recording->warnings(), IsEmpty());
}

TEST_F(SingleCameraOfPair, OpensTheRightAloneWithItsBodyPose) {
  const OpenOptions right = options(CameraChoice::right);
  const auto recording = open(right);
  EXPECT_EQ(camera_of(*recording, right), CameraChoice::right);
  EXPECT_FALSE(recording->calibration().right);
  EXPECT_EQ(recording->calibration().left.cx, 16.5);
  EXPECT_THAT(recording->calibration().body_from_left.translation, PointNear(Eigen::Vector3d(0.3, 0.0, 0.0), 1e-12));
  EXPECT_THAT(recording->times(), ElementsAre(milliseconds(100), milliseconds(300))) << "the second has no right image";
  EXPECT_THAT(greys_of(*recording), ElementsAre(15, 35));
  EXPECT_FALSE(recording->read(0)->right);
}

TEST_F(SingleCameraOfPair, OpensOneOfCamerasWithoutRelativePose) {
  std::string text = kPair;
  text.replace(text.find("T_cn_cnm1"), 9, "other_pose");
  const fs::path file = calibration(text);
  for (const auto& [camera, name, cx] :
       {std::tuple(CameraChoice::left, "#cam0", 15.5), std::tuple(CameraChoice::right, "#cam1", 16.5)}) {
    const auto recording = open({camera, file});
    EXPECT_EQ(recording->calibration().left.cx, cx);
    EXPECT_FALSE(recording->calibration().right);
    EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr(name))) << "names the camera";
    const auto named = open({camera, file.string() + "#cam1"});
    EXPECT_EQ(named->calibration().left.cx, 16.5) << "the given camera, with images of either side";
    EXPECT_EQ(greys_of(*named), greys_of(*recording));
  }
  EXPECT_THAT(open_error({CameraChoice::stereo, file}), HasSubstr("cameras.yaml: cam1."));
  EXPECT_THAT(open_error({{}, file}), HasSubstr("one camera alone: "));
}

TEST_F(SingleCameraOfPair, KeepsTheGivenReadoutTime) {
  for (const CameraChoice camera : {CameraChoice::left, CameraChoice::right}) {
    const OpenOptions options{
        camera, calibration(camera_yaml("cam0", "  readout_time: 0.015\n") + kPair.substr(kPair.find("cam1")))};
    EXPECT_EQ(open(options)->calibration().readout_time, 0.015);
  }
}

TEST_F(SingleCameraOfPair, CountsFramesEquallyForBothCameras) {
  EXPECT_THAT(open(options(CameraChoice::right), {.first = 2})->times(), ElementsAre(milliseconds(300)));
  EXPECT_THAT(open_error(options(CameraChoice::right), {.first = 1, .last = 2}),
              HasSubstr("no frame in the selected range has a right image"));
  EXPECT_FALSE(open(options({}), {.first = 1, .last = 2})->read(0)->right);
}

TEST_F(SingleCameraOfPair, NeedsNoCalibrationOfTheOther) {
  const auto recording = open({.calibration = calibration(kOne)});
  EXPECT_FALSE(recording->calibration().right);
  EXPECT_FALSE(recording->read(0)->right);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("right images are ignored")));
  EXPECT_THAT(open_error({CameraChoice::stereo, calibration(kOne)}), HasSubstr("has a calibration of one camera only"));
  EXPECT_THAT(open_error({CameraChoice::right, calibration(kOne)}),
              HasSubstr("has a calibration without right camera"));
}

TEST_F(SingleCameraOfPair, HasTheSizeOfItsOwnCalibration) {
  for (int i = 1; i <= 3; ++i) write_image("mav0/cam1/data/" + std::to_string(i) + ".png", 16, 12, 5);
  EXPECT_EQ(open(options(CameraChoice::left))->size(), 3);
  EXPECT_THAT(open_error(options(CameraChoice::right)), HasSubstr("cameras.yaml: is 32x24, but the images are 16x12"));
}

TEST_F(SingleCameraOfPair, RejectsAFrameRateForStampedImages) {
  OpenOptions timed = options({});
  timed.frame_rate_hz = 20.0;
  EXPECT_THAT(open_error(timed), HasSubstr("has time stamps; a frame rate is not accepted"));
}

class TumRecording : public SingleCamera {
 protected:
  TumRecording() {
    write("rgb.txt",
          "# color images\n# timestamp filename\n1305031102.175304 rgb/a.png\n1305031102.211214 rgb/b.png\n");
    write("camera.yaml", kOne);
    write_frame("rgb/a.png", 10);
    write_frame("rgb/b.png", 20);
  }
};

TEST_F(TumRecording, ReadsColourImagesOfOneCamera) {
  const auto recording = open();
  EXPECT_EQ(guess_format(folder_), RecordingFormat::tum);
  EXPECT_THAT(recording->times(), ElementsAre(Timestamp(1305031102175304000), Timestamp(1305031102211214000)));
  EXPECT_THAT(greys_of(*recording), ElementsAre(10, 20));
  EXPECT_FALSE(recording->calibration().right);
  EXPECT_THAT(recording->warnings(), IsEmpty());
  EXPECT_EQ(open({}, {.first = 1})->size(), 1);
}

TEST_F(TumRecording, FindsItsGroundTruth) {
  EXPECT_FALSE(find_ground_truth(folder_));
  write("groundtruth.txt", "");
  EXPECT_EQ(find_ground_truth(folder_), folder_ / "groundtruth.txt");
}

TEST_F(TumRecording, PrefersTheGivenCalibration) {
  EXPECT_NEAR(open({.calibration = calibration(kPair)})->calibration().body_from_left.translation.x(), 0.1, 1e-12);
  EXPECT_EQ(open({CameraChoice::right, calibration(kPair)})->calibration().left.cx, 16.5);
  EXPECT_THAT(open_error({CameraChoice::stereo, calibration(kPair)}), HasSubstr("has images of one camera only"));
}

TEST_F(TumRecording, ReportsAMissingCalibration) {
  fs::remove(folder_ / "camera.yaml");
  EXPECT_THAT(open_error(), HasSubstr("contains no camera calibration (give one with --calibration FILE, or add it"));
  EXPECT_THAT(open_error({.calibration = folder_ / "absent.yaml"}), HasSubstr("absent.yaml: cannot be opened"));
}

TEST_F(TumRecording, ReportsTheInvalidLineOfTheList) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"#\n2.0 rgb/a.png\n2.0 rgb/b.png\n", "rgb.txt: all of its 2 images have the same time stamp"},
      {"noon rgb/a.png\n", "rgb.txt:1: \"noon\" is not a time in seconds"},
      {"1.0\n", "rgb.txt:1: has no name of an image file"},
      {"# nothing\n", "rgb.txt: lists no images"},
  };
  for (const auto& [list, message] : cases) {
    write("rgb.txt", list);
    EXPECT_THAT(open_error(), HasSubstr(message));
  }
}

class ImageFolder : public SingleCamera {
 protected:
  ImageFolder() { write("calibration.yaml", kOne); }
};

TEST_F(ImageFolder, ReadsTimesFromNames) {
  write_frame("1403636579813555456.png", 20);
  write_frame("1403636579763555584.png", 10);
  const auto recording = open();
  EXPECT_EQ(guess_format(folder_), RecordingFormat::images);
  EXPECT_THAT(recording->times(), ElementsAre(Timestamp(1403636579763555584), Timestamp(1403636579813555456)));
  EXPECT_THAT(greys_of(*recording), ElementsAre(10, 20));
  EXPECT_THAT(recording->warnings(), IsEmpty());
}

TEST_F(ImageFolder, SortsShortNamesByTime) {
  write_frame("12.25.png", 10);
  write_frame("12.5.png", 20);
  EXPECT_THAT(open()->times(), ElementsAre(milliseconds(12250), milliseconds(12500)));
  write_frame("12.50.png", 30);
  EXPECT_THAT(open_error(), HasSubstr("has the same time stamp as 12.5"));
}

TEST_F(ImageFolder, UsesTheGivenRateOrWarnsOfThirtyHertz) {
  for (const int i : {1, 9, 10}) write_frame("frame" + std::to_string(i) + ".png", 10 * i);
  const auto steady = open({.frame_rate_hz = 20.0});
  EXPECT_THAT(steady->times(), ElementsAre(milliseconds(0), milliseconds(50), milliseconds(100)));
  EXPECT_THAT(greys_of(*steady), ElementsAre(10, 90, 100));
  EXPECT_THAT(steady->warnings(), IsEmpty());
  const auto assumed = open();
  EXPECT_NEAR(to_seconds(assumed->times()[1]), 1.0 / 30.0, 1e-9);
  EXPECT_THAT(assumed->warnings(), ElementsAre(HasSubstr("30 frames per second are assumed")));
}

TEST_F(ImageFolder, ReadsAPairFromLeftAndRightFolders) {
  write("calibration.yaml", kPair);
  for (const int i : {1, 2}) {
    write_frame("left/" + std::to_string(i) + ".png", 10 * i);
    write_frame("right/" + std::to_string(i) + ".png", 10 * i + 5);
  }
  const auto pair = open({.frame_rate_hz = 10.0});
  ASSERT_TRUE(pair->calibration().right);
  EXPECT_EQ(pair->read(1)->right->pixels.back(), 25);
  EXPECT_THAT(greys_of(*open({.camera = CameraChoice::right, .frame_rate_hz = 10.0})), ElementsAre(15, 25));
  EXPECT_THAT(greys_of(*open({.camera = CameraChoice::left, .frame_rate_hz = 10.0})), ElementsAre(10, 20));

  write_frame("right/3.png", 35);
  EXPECT_THAT(open_error(), HasSubstr("contains 2 left and 3 right images, and their names do not define pairs"));
}

TEST_F(ImageFolder, PairsImagesByTheTimesOfTheirNames) {
  write("calibration.yaml", kPair);
  for (const char* const name : {"left/1000000000.png", "left/1050000000.png", "left/1100000000.png",
                                 "right/1000500000.png", "right/1100500000.png"}) {
    write_frame(name, 50);
  }
  const auto recording = open();
  EXPECT_TRUE(recording->read(0)->right);
  EXPECT_FALSE(recording->read(1)->right);
  EXPECT_TRUE(recording->read(2)->right);
}

TEST_F(ImageFolder, RejectsUnpairedImages) {
  write_image("1.png", 16, 12, 10);
  EXPECT_THAT(open_error(), HasSubstr("calibration.yaml: is 32x24, but the images are 16x12"));
  fs::remove(folder_ / "1.png");
  EXPECT_THAT(open_error(), HasSubstr("contains no recording in a supported format"));
}

// Five frames of a video, with grey values 40, 80 and so on.
class VideoFile : public SingleCamera {
 protected:
  VideoFile() {
    write("calibration.yaml", kOne);
    cv::VideoWriter writer(file_.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0,
                           {32, 24});
    for (int i = 1; i <= 5; ++i) writer.write(cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(40 * i)));
  }

  std::unique_ptr<Recording> open_film(const OpenOptions& options = {}, const FrameRange& range = {}) const {
    return open_recording(file_, range, options);
  }
  std::string film_error(const OpenOptions& options = {}) const {
    return error_of([&] { open_film(options); });
  }

  const fs::path file_ = folder_ / "film.avi";
};

TEST_F(VideoFile, ReturnsFramesAtItsRate) {
  const auto recording = open_film();
  EXPECT_EQ(guess_format(file_), RecordingFormat::video);
  EXPECT_THAT(recording->times(),
              ElementsAre(milliseconds(0), milliseconds(50), milliseconds(100), milliseconds(150), milliseconds(200)));
  for (int i = 0; i < recording->size(); ++i) {
    const std::optional<ImageFrame> frame = recording->read(i);
    ASSERT_TRUE(frame) << i;
    EXPECT_NEAR(frame->left.pixels.back(), 40 * (i + 1), 4);
    EXPECT_FALSE(frame->right);
  }
  EXPECT_THAT(recording->warnings(), IsEmpty());
  EXPECT_EQ(open_film({.frame_rate_hz = 10.0})->times()[1], milliseconds(100));
}

TEST_F(VideoFile, ReturnsExactFramesInAnyOrder) {
  const auto recording = open_film({}, {.first = 1, .stride = 2});
  EXPECT_THAT(recording->times(), ElementsAre(milliseconds(50), milliseconds(150)));
  EXPECT_NEAR(recording->read(1)->left.pixels.back(), 160, 4);
  EXPECT_NEAR(recording->read(0)->left.pixels.back(), 80, 4);
  EXPECT_NEAR(recording->read(1)->left.pixels.back(), 160, 4);
}

TEST_F(VideoFile, ReportsErrors) {
  EXPECT_THAT(film_error({.camera = CameraChoice::stereo}), HasSubstr("film.avi: has images of one camera only"));
  write("calibration.yaml", "cam0:\n  camera_model: ocam\n");
  EXPECT_THAT(film_error(), HasSubstr("calibration.yaml: cam0.camera_model: \"ocam\" is not supported"));
  fs::remove(folder_ / "calibration.yaml");
  EXPECT_THAT(film_error(), HasSubstr("contains no camera calibration"));
  write("film.avi", "no film");
  EXPECT_THAT(film_error({.calibration = calibration(kOne)}), HasSubstr("film.avi: cannot be opened as a video"));
}

TEST_F(VideoFile, RejectsAnotherSizeThanCalibrated) {
  std::string large = kOne;
  large.replace(large.find("[32, 24]"), 8, "[64, 48]");
  EXPECT_THAT(film_error({.calibration = calibration(large)}),
              HasSubstr("cameras.yaml: is 64x48, but the images are 32x24"));
}

}  // namespace
}  // namespace byre
