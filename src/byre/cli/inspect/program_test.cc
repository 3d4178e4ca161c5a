// "byre inspect" and "byre validate".

#include "byre/cli/shared/program_fixture.h"
#include "byre/extrinsics_file.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/stored_map_scene.h"
#include "byre/odometry/odometry_calibration.h"

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class InspectProgram : public ProgramTest {
 protected:
  InspectProgram() {
    const StoredMap stored = StoredMapScene(4, 9).stored();
    save_map(stored, folder_ / "barn.byre");
    MapBytes bytes = write_map(stored);
    bytes[section_of(bytes, "points").offset + 9] ^= std::byte{1};
    write("damaged.byre", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    write("text.byre", "not a map");
  }
};

TEST_F(InspectProgram, PrintsAReport) {
  const Outcome outcome = run("inspect barn.byre");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("map            barn.byre\n"));
  EXPECT_THAT(outcome.output, HasSubstr("points         16, with 32 observations\n"));
  EXPECT_THAT(outcome.errors, IsEmpty());
}

TEST_F(InspectProgram, PrintsJsonAndWritesThePoints) {
  const Outcome outcome = run("inspect barn.byre --json --points points.ply");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("{\n  \"file\": {"));
  EXPECT_THAT(read("points.ply"), HasSubstr("element vertex 16\n"));
}

TEST_F(InspectProgram, CountsAndWritesPictures) {
  save_map(with_pictures(StoredMapScene(4, 9).stored()), folder_ / "pictured.byre");
  const Outcome outcome = run("inspect pictured.byre --pictures pictures");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("pictures       of 3 keyframes, 66 B\n"));
  EXPECT_EQ(read("pictures/000002.jpg"), std::string(22, '\2'));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "pictures" / "000001.jpg"));
  EXPECT_THAT(run("inspect barn.byre").output, HasSubstr("pictures       none\n"));
}

TEST_F(InspectProgram, WritesExtrinsicsOfTheRobot) {
  StoredMap stored = StoredMapScene(4, 9).stored();
  OdometryCalibration known;
  WheelCalibration& wheels = known.wheels.emplace();
  wheels.base_from_body = {rotation_exp({-1.2, 1.2, -1.1}), {0.4, 0.1, 0.0}};
  wheels.metres_per_unit = 0.98;
  WheelDeviation sigmas;
  sigmas << 0.003, 0.003, 0.003, 0.012, 0.012, 1.0, 0.002, 0.003, 0.001;
  wheels.covariance = sigmas.cwiseAbs2().asDiagonal();
  known.time_offset = 0.03;
  for (const bool is_metric : {true, false}) {
    stored.scale = is_metric ? MapScale::metric : MapScale::unknown;
    write_odometry_calibration(known, stored.notes);
    save_map(stored, folder_ / "driven.byre");
    const Outcome outcome = run("inspect driven.byre --extrinsics robot.yaml");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.output, HasSubstr("extrinsics     robot.yaml; the height of the camera is not estimated\n"));
    const Extrinsics extrinsics = read_extrinsics(folder_ / "robot.yaml");
    ASSERT_TRUE(extrinsics.camera);
    EXPECT_THAT(extrinsics.camera->base_from_sensor,
                PoseNear(wheels.base_from_body * stored.recordings[0].calibration.body_from_left, 1e-9, 1e-7));
    EXPECT_GT(extrinsics.camera->sigma_m, 0.03);
    EXPECT_LT(extrinsics.camera->sigma_m, 0.06);
    EXPECT_GT(extrinsics.camera->sigma_rad, 0.01);
    EXPECT_LT(extrinsics.camera->sigma_rad, 0.04);
    EXPECT_NEAR(extrinsics.wheel_scale, is_metric ? 1.0 / 0.98 : 1.0, 1e-12);
    EXPECT_GT(extrinsics.wheel_scale_sigma, 0.002);
    EXPECT_EQ(extrinsics.wheel_delay, 0.03);
  }
}

TEST_F(InspectProgram, WritesNoExtrinsicsWithoutWheels) {
  const Outcome outcome = run("inspect barn.byre --extrinsics robot.yaml");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("barn.byre: has no calibration of wheels"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "robot.yaml"));
}

TEST_F(InspectProgram, RejectsOtherFiles) {
  for (const char* const command : {"inspect", "validate"}) {
    const Outcome damaged = run(std::string(command) + " damaged.byre");
    EXPECT_EQ(damaged.exit_code, 3);
    EXPECT_THAT(damaged.errors, StartsWith("byre: error: damaged.byre: section points at byte "));
    EXPECT_THAT(damaged.output, IsEmpty());
    EXPECT_EQ(run(std::string(command) + " text.byre").exit_code, 3);
    EXPECT_EQ(run(std::string(command) + " absent.byre").exit_code, 3);
    EXPECT_EQ(run(command).exit_code, 2);
  }
}

TEST_F(InspectProgram, ValidatesASoundMap) {
  const Outcome outcome = run("validate barn.byre");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.output, "barn.byre: sound, 5 keyframes, 16 points\n");
}

}  // namespace
}  // namespace byre::cli
