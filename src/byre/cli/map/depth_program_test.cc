// Mapping with a depth camera, and missions with one and two cameras on that map.

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/trajectory_file.h"

#include <cmath>
#include <sstream>
#include <string>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr int kFramesPerDepth = 3;  // every third frame has a depth image
constexpr double kUnitsPerMetre = 1000.0;

const Calibration& pair() {
  static const Calibration calibration = euroc_like_calibration(2);
  return calibration;
}

// Depths along the optical axis per pixel of the left camera, big-endian.
std::string depth_bytes(const RenderedRoom& room, const Camera& lens, const Pose& world_from_left) {
  std::string bytes;
  const Eigen::Vector3f origin = world_from_left.translation.cast<float>();
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const auto bearing = lens.bearing({u, v});
      double depth = 0.0;
      if (bearing) {
        const Eigen::Vector3d along = world_from_left.rotation * *bearing;
        depth = room.hit(origin, along.cast<float>()).distance * bearing->z();
      }
      const auto units = static_cast<std::uint16_t>(std::lround(kUnitsPerMetre * depth));
      bytes += static_cast<char>(units >> 8);
      bytes += static_cast<char>(units & 0xFF);
    }
  }
  return bytes;
}

std::string numbers(const Eigen::Matrix4d& matrix) {
  std::ostringstream text;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) text << (row + column > 0 ? ", " : "") << matrix(row, column);
  }
  return "[" + text.str() + "]";
}

void write_calibration(const fs::path& file) {
  const Camera& lens = pair().left;
  Eigen::Matrix4d body_from_left = Eigen::Matrix4d::Identity();
  body_from_left.topLeftCorner<3, 3>() = pair().body_from_left.rotation.toRotationMatrix();
  body_from_left.topRightCorner<3, 1>() = pair().body_from_left.translation;
  std::ofstream yaml(file);
  yaml.precision(17);
  yaml << "resolution: [" << lens.width << ", " << lens.height << "]\ncamera_model: pinhole\nintrinsics: [" << lens.fx
       << ", " << lens.fy << ", " << lens.cx << ", " << lens.cy << "]\ndistortion_model: radial-tangential\n"
       << "distortion_coefficients: [" << lens.distortion[0] << ", " << lens.distortion[1] << ", " << lens.distortion[2]
       << ", " << lens.distortion[3] << "]\nT_BS: " << numbers(body_from_left) << "\ndepth_scale: " << kUnitsPerMetre
       << "\n";
}

// Left images of the bend with depth images. The destructor removes the files.
class DepthFixture {
 public:
  DepthFixture() {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "rgb");
    fs::create_directories(folder_ / "depth");
    write_calibration(folder_ / "camera.yaml");
    const RenderedRoom room{RenderedRoomOptions{}};
    const Camera& lens = pair().left;
    std::ofstream colours(folder_ / "rgb.txt"), depths(folder_ / "depth.txt");
    const Trajectory& truth = bend_recording().truth();
    write_trajectory(truth, folder_ / "groundtruth.txt");
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const auto& [time, world_from_body] = truth[i];
      const std::string name = std::to_string(i);
      const std::string seconds = fmt::format("{:.6f}", to_seconds(time));
      fs::copy(bend_recording().image("cam0", i), folder_ / "rgb" / (name + ".png"));
      colours << seconds << " rgb/" << name << ".png\n";
      if (i % kFramesPerDepth != 0) continue;
      std::ofstream(folder_ / "depth" / (name + ".pgm"), std::ios::binary)
          << "P5\n"
          << lens.width << " " << lens.height << "\n65535\n"
          << depth_bytes(room, lens, world_from_body * pair().body_from_left);
      depths << seconds << " depth/" << name << ".pgm\n";
    }
  }
  ~DepthFixture() { fs::remove_all(folder_); }
  DepthFixture(const DepthFixture&) = delete;
  DepthFixture& operator=(const DepthFixture&) = delete;

  std::string quoted() const { return "'" + folder_.string() + "'"; }

 private:
  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_cli_depth_room." + std::to_string(getpid()));
};

const std::string& with_depth() {
  static const DepthFixture recording;
  static const std::string quoted = recording.quoted();
  return quoted;
}

class DepthProgram : public ProgramTest {
 protected:
  double error_of_mission(const std::string& arguments) {
    const Outcome outcome = run("run " + arguments + " --stats mission.json --quiet");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    if (outcome.exit_code != 0) return std::nan("");
    const json mission = json::parse(read("mission.json"));
    EXPECT_EQ(mission["counts"]["coverage"], 1.0);
    return mission["errors"]["final"]["position_m"]["rmse"];
  }
};

TEST_F(DepthProgram, MapsInMetresAndCountsFramesWithDepth) {
  const Outcome outcome =
      run("map " + with_depth() + " --camera rgbd -o depth.byre --trajectory t.txt --stats s.json" + " --quiet");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("40 frames, 14 with depth images"));
  const json stats = json::parse(read("s.json"));
  EXPECT_EQ(stats["protocol"]["camera"], "rgbd");
  EXPECT_EQ(stats["protocol"]["scale"], "metric");
  EXPECT_EQ(stats["counts"]["frames_with_depth_image"], 14);
  EXPECT_EQ(stats["counts"]["coverage"], 1.0);
  const StoredMap stored = load_map(folder_ / "depth.byre");
  EXPECT_EQ(stored.scale, MapScale::metric);
  EXPECT_TRUE(stored.map.rigs().front().is_stereo());
  EXPECT_THAT(run("inspect depth.byre").output, HasSubstr(" keyframes, rgbd\n"));
  const Outcome judged = run("evaluate --estimate t.txt --truth " + with_depth() + " --alignment se3 --json");
  ASSERT_EQ(judged.exit_code, 0) << judged.errors;
  EXPECT_LT(json::parse(judged.output)["ate"]["translation_m"]["rmse"], 0.02);
}

TEST_F(DepthProgram, MakesAMapForOneCameraAndRunsOnAStereoMap) {
  ASSERT_EQ(run("map " + with_depth() + " -o depth.byre --quiet").exit_code, 0);
  ASSERT_EQ(run_once("map " + rendered_bend() + " -o stereo.byre --quiet").exit_code, 0);
  const std::string truth = " --truth " + with_depth();
  EXPECT_LT(error_of_mission(with_depth() + " --camera left --map depth.byre" + truth), 0.02);
  EXPECT_LT(error_of_mission(rendered_bend() + " --map depth.byre" + truth), 0.02);
  EXPECT_LT(error_of_mission(with_depth() + " --camera rgbd --map stereo.byre" + truth), 0.02);
}

TEST_F(DepthProgram, RejectsARecordingWithoutDepth) {
  const Outcome refused = run("map " + rendered_bend() + " --camera rgbd -o out.byre --quiet");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.errors, HasSubstr("has no depth images"));
}

}  // namespace
}  // namespace byre::cli
