#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/recording.h"
#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_trajectory_scene.h"
#include "byre/trajectory_file.h"

#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr int kFrames = 3;

std::vector<std::string> lines_of(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

// Written for each test into a separate folder.
class WrittenRecording : public ::testing::Test {
 protected:
  WrittenRecording() {
    fs::remove_all(folder);
    write_euroc_recording(room, calibration, truth, folder, [&](int done, int total) {
      progress.push_back({done, total});
    });
  }
  ~WrittenRecording() override { fs::remove_all(folder); }

  const fs::path folder =
      fs::path(::testing::TempDir()) /
      (std::string("byre_rendered_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
  const RenderedRoom room{RenderedRoomOptions{}};
  const Calibration calibration = euroc_like_calibration(4);
  const Trajectory truth = circling_trajectory(kFrames, 20.0, 1.0, 0.02, calibration.body_from_left);
  std::vector<std::pair<int, int>> progress;
};

TEST_F(WrittenRecording, HasTheFilesOfEuroc) {
  const fs::path mav = folder / "mav0";
  for (const char* camera : {"cam0", "cam1"}) {
    EXPECT_THAT(lines_of(mav / camera / "data.csv"),
                ElementsAre("#timestamp [ns],filename", "0,0.png", "50000000,50000000.png", "100000000,100000000.png"));
    EXPECT_TRUE(fs::exists(mav / camera / "data" / "50000000.png"));
    EXPECT_THAT(lines_of(mav / camera / "sensor.yaml"),
                ::testing::AllOf(::testing::Contains("sensor_type: camera"), ::testing::Contains("T_BS:"),
                                 ::testing::Contains("camera_model: pinhole"), ::testing::Contains("rate_hz: 20"),
                                 ::testing::Contains("distortion_model: radial-tangential"),
                                 ::testing::Contains("resolution: [188, 120]")));
  }
}

TEST_F(WrittenRecording, HasGroundTruthInTheColumnsOfEuroc) {
  const std::vector<std::string> lines = lines_of(folder / "mav0" / "state_groundtruth_estimate0" / "data.csv");
  ASSERT_THAT(lines, SizeIs(kFrames + 1));
  EXPECT_THAT(lines[0], StartsWith("#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x []"));
  for (std::size_t i = 1; i < lines.size(); ++i) EXPECT_EQ(std::ranges::count(lines[i], ','), 16);
  EXPECT_THAT(lines[2], StartsWith("50000000,"));
}

TEST_F(WrittenRecording, ReadsBackTheTruth) {
  const Trajectory read = read_trajectory(folder);
  ASSERT_THAT(read, SizeIs(kFrames));
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].time, truth[i].time);
    EXPECT_THAT(read[i].world_from_body, PoseNear(truth[i].world_from_body, 1e-12, 1e-7));
  }
}

TEST_F(WrittenRecording, ReadsBackItsCalibration) {
  const Calibration read = open_recording(folder, {})->calibration();
  EXPECT_EQ(read.left.fx, calibration.left.fx);
  EXPECT_EQ(read.left.cy, calibration.left.cy);
  EXPECT_EQ(read.left.distortion, calibration.left.distortion);
  EXPECT_THAT(read.body_from_left, PoseNear(calibration.body_from_left, 1e-12, 1e-7));
  ASSERT_TRUE(read.right);
  EXPECT_EQ(read.right->camera.fy, calibration.right->camera.fy);
  EXPECT_THAT(read.right->right_from_left, PoseNear(calibration.right->right_from_left, 1e-12, 1e-7));
}

TEST_F(WrittenRecording, ReadsBackTheRenderedImages) {
  const auto recording = open_recording(folder, {});
  ASSERT_EQ(recording->size(), kFrames);
  const std::optional<ImageFrame> read = recording->read(1);
  const ImageFrame rendered = room.render(calibration, truth[1].world_from_body, truth[1].time);
  ASSERT_TRUE(read && read->right);
  EXPECT_EQ(read->left.pixels, rendered.left.pixels);
  EXPECT_EQ(read->right->pixels, rendered.right->pixels);
}

TEST_F(WrittenRecording, ReportsItsProgress) {
  EXPECT_THAT(progress, ElementsAre(std::pair(1, 3), std::pair(2, 3), std::pair(3, 3)));
}

TEST_F(WrittenRecording, RejectsAFileInItsPlace) {
  const fs::path occupied = folder / "occupied";
  std::ofstream(occupied) << "a file";
  try {
    write_euroc_recording(room, calibration, truth, occupied, {});
    FAIL() << "should have thrown";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot be written"));
  }
}

}  // namespace
}  // namespace byre
