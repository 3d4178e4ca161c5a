// Round trip of a map through a COLMAP model and COLMAP's own programs.

#include "byre/cli/shared/program_fixture.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/io/colmap/colmap_model.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_trajectory_scene.h"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A small rendered recording in the test's folder and its map with true poses.
class ColmapProgram : public ProgramTest {
 protected:
  void SetUp() override {
    if (std::system("command -v colmap >/dev/null") != 0) GTEST_SKIP() << "needs the program colmap (Debian: colmap)";
    const Calibration calibration = euroc_like_calibration(4);
    const Trajectory truth = figure_eight_trajectory(6, 5.0, 3.0, 0.1, calibration.body_from_left);
    write_euroc_recording(RenderedRoom({}), calibration, truth, folder_ / "room", {});
    require(run("map room --poses room -o room.byre --quiet"));
  }

  static void require(const Outcome& outcome) { ASSERT_EQ(outcome.exit_code, 0) << outcome.errors; }

  // Runs colmap; returns stdout and stderr.
  std::string colmap(const std::string& arguments) const {
    const std::string command =
        "cd '" + folder_.string() + "' && QT_QPA_PLATFORM=offscreen colmap " + arguments + " >colmap.txt 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << arguments << "\n" << read("colmap.txt");
    return read("colmap.txt");
  }

  void make(const std::string& name) const { fs::create_directory(folder_ / name); }
};

void expect_same_positions(const ColmapModel& model, const ColmapModel& original) {
  ASSERT_EQ(model.images.size(), original.images.size());
  for (const auto& [id, image] : original.images) {
    EXPECT_EQ(model.images.at(id).name, image.name);
    EXPECT_THAT(inverse(model.images.at(id).camera_from_world).translation,
                PointNear(inverse(image.camera_from_world).translation, 1e-9));
  }
  ASSERT_EQ(model.points.size(), original.points.size());
  for (const auto& [id, point] : original.points) {
    EXPECT_THAT(model.points.at(id).position_in_world, PointNear(point.position_in_world, 1e-9));
    EXPECT_EQ(model.points.at(id).track.size(), point.track.size());
  }
}

TEST_F(ColmapProgram, ReadsTheContentOfTheMapFromAnExportedModel) {
  const MapGraph map = load_map(folder_ / "room.byre").map;
  const std::vector<PointId> ids = map.point_ids();
  const auto points = std::ranges::count_if(ids, [&map](PointId id) { return map.observations(id).size() >= 2; });
  for (const std::string format : {"text", "binary"}) {
    require(run("export-colmap room.byre -o " + format + " --" + format));
    const std::string analysis = colmap("model_analyzer --path " + format);
    EXPECT_THAT(analysis, HasSubstr("Registered images: 6"));
    EXPECT_THAT(analysis, HasSubstr("Points: " + std::to_string(points) + "\n"));
  }
}

TEST_F(ColmapProgram, ConvertsAnExportedModelWithoutMovingPoints) {
  require(run("export-colmap room.byre -o binary"));
  require(run("export-colmap room.byre -o text --text"));
  make("to_text");
  make("to_binary");
  colmap("model_converter --input_path binary --output_path to_text --output_type TXT");
  colmap("model_converter --input_path text --output_path to_binary --output_type BIN");
  const ColmapModel original = read_colmap_model(folder_ / "binary");
  expect_same_positions(read_colmap_model(folder_ / "to_text"), original);
  expect_same_positions(read_colmap_model(folder_ / "to_binary"), original);
}

// Poses and points survive the round trip. Points are matched by position because ids change.
TEST_F(ColmapProgram, ReturnsAMapWithTheSamePositions) {
  require(run("export-colmap room.byre -o binary"));
  make("to_text");
  colmap("model_converter --input_path binary --output_path to_text --output_type TXT");
  const Outcome imported = run("import-colmap to_text room/mav0/cam0/data -o back.byre --scale 1 --quiet");
  require(imported);
  EXPECT_THAT(imported.output, HasSubstr("keyframes          6"));

  const MapGraph original = load_map(folder_ / "room.byre").map;
  const StoredMap stored = load_map(folder_ / "back.byre");
  EXPECT_EQ(stored.scale, MapScale::metric);
  ASSERT_EQ(stored.map.keyframe_count(), original.keyframe_count());
  for (const KeyframeId id : original.keyframe_ids()) {
    EXPECT_THAT(inverse(stored.map.camera_from_world(id)).translation,
                PointNear(inverse(original.camera_from_world(id)).translation, 1e-9));
  }
  int known_again = 0;
  for (const PointId id : stored.map.point_ids()) {
    const Eigen::Vector3d& position = stored.map.find_point(id)->position_in_world;
    for (const PointId other : original.point_ids()) {
      if ((original.find_point(other)->position_in_world - position).norm() > 1e-9) continue;
      ++known_again;
      break;
    }
  }
  EXPECT_THAT(imported.output, HasSubstr("points             " + std::to_string(known_again) + " of the model's"));
  EXPECT_GT(known_again, 50);
}

// Bundle adjustment starts from poses and points consistent with the keypoints, so its initial cost is small.
TEST_F(ColmapProgram, ConfirmsThatPointsProjectOntoTheirKeypoints) {
  require(run("export-colmap room.byre -o binary"));
  make("adjusted");
  const std::string report = colmap(
      "bundle_adjuster --input_path binary --output_path adjusted --BundleAdjustment.refine_focal_length 0 "
      "--BundleAdjustment.refine_extra_params 0");
  const std::size_t at = report.find("Initial cost : ");
  ASSERT_NE(at, std::string::npos) << report;
  EXPECT_LT(std::stod(report.substr(at + std::string("Initial cost : ").size())), 0.5);  // pixels
}

}  // namespace
}  // namespace byre::cli
