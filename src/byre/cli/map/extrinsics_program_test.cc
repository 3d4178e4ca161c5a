// Mapping with given extrinsics and wheels; extrinsics of "byre calibrate".

#include "byre/cli/shared/program_fixture.h"
#include "byre/extrinsics_file.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/map/map_file.h"
#include "byre/simulation/euroc_writer.h"
#include "byre/simulation/motion_sensors.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/simulation/simulated_trajectory_scene.h"
#include "byre/trajectory_file.h"

#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Base of a robot with a camera ahead of the axle, to its left and above it.
Pose base_from_camera() {
  return {robot_from_camera().rotation, {0.4, 0.1, 0.9}};
}

// A robot with two driven wheels and one camera on a bend to the left. Rendered once.
class DrivenBend {
 public:
  DrivenBend() {
    MotionSensorOptions errors;
    errors.radius_error = 0.0;
    write_motion(simulate_motion(path(196, 100.0), errors), recording_.folder());
  }

  std::string folder() const { return quoted(recording_.folder()); }
  const Trajectory& truth() const { return recording_.truth(); }

 private:
  // Path of the base, below a camera that circles.
  static Trajectory path(int poses, double rate_hz) {
    return circling_trajectory(poses, rate_hz, 2.0, 0.25, {robot_from_camera().rotation, {0.0, 0.0, 0.9}});
  }
  static Calibration calibration() {
    Calibration calibration = euroc_like_calibration(2);
    calibration.right.reset();
    calibration.body_from_left = base_from_camera();
    return calibration;
  }

  RenderedFixture recording_{"byre_cli_driven_bend", calibration(), path(40, 20.0)};
};

class ExtrinsicsProgram : public ProgramTest {
 protected:
  ExtrinsicsProgram() {
    Extrinsics extrinsics;
    extrinsics.camera = SensorMounting{base_from_camera()};
    write_extrinsics(folder_ / "robot.yaml", extrinsics);
  }

  static const DrivenBend& bend() {
    static const DrivenBend bend;
    return bend;
  }
};

TEST_F(ExtrinsicsProgram, MapsWithOneCameraInMetresFromTheFirstFrameOn) {
  const Outcome outcome = run("map " + bend().folder() +
                              " --extrinsics robot.yaml -o mono.byre --trajectory final.txt "
                              "--causal-trajectory causal.txt --stats s.json --quiet");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("metric by wheel odometry"));
  EXPECT_EQ(load_map(folder_ / "mono.byre").scale, MapScale::metric);
  const Trajectory causal = read_trajectory(folder_ / "causal.txt");
  const std::size_t frames = bend().truth().size();
  ASSERT_GE(causal.size(), frames - 2) << "the first sample of the wheels is 30 ms after the first frame";
  EXPECT_EQ(causal.back().time, bend().truth().back().time);
  EXPECT_GE(read_trajectory(folder_ / "final.txt").size(), frames - 1);
  for (const std::string path : {"causal.txt", "final.txt"}) {
    const Outcome judged = run("evaluate --estimate " + path + " --truth " + bend().folder() + " --frames-of " +
                               bend().folder() + " --estimate-of camera --alignment se3 --json");
    ASSERT_EQ(judged.exit_code, 0) << judged.errors;
    EXPECT_LT(json::parse(judged.output)["ate"]["translation_m"]["rmse"], 0.01) << path;
  }
}

TEST_F(ExtrinsicsProgram, RefusesTheRightCameraAndFramesWithoutAFile) {
  const Outcome right = run("map " + rendered_room() + " --camera right --extrinsics robot.yaml -o out.byre --quiet");
  EXPECT_EQ(right.exit_code, 3);
  EXPECT_THAT(right.errors, HasSubstr("robot.yaml: has the pose of the left camera"));
  const Outcome frame = run("map " + rendered_room() + " --base-frame base_link -o out.byre --quiet");
  EXPECT_EQ(frame.exit_code, 2);
  EXPECT_THAT(frame.errors, HasSubstr("--base-frame requires --extrinsics"));
}

TEST_F(ExtrinsicsProgram, AreWrittenByCalibrateFromWheelsOfTheLeftCameraOnly) {
  const Outcome without = run("calibrate " + rendered_room() + " -o new.yaml --extrinsics found.yaml --quiet");
  EXPECT_EQ(without.exit_code, 3);
  EXPECT_THAT(without.errors, HasSubstr("has no wheel odometry, which extrinsics are estimated from"));
  const Outcome right =
      run("calibrate " + rendered_room() + " --camera right -o new.yaml --extrinsics found.yaml --quiet");
  EXPECT_EQ(right.exit_code, 3);
  EXPECT_THAT(right.errors, HasSubstr("found.yaml: takes the pose of the left camera"));
  EXPECT_EQ(names_of_files(), (std::set<std::string>{"robot.yaml", "stderr.txt", "stdout.txt"}));
}

}  // namespace
}  // namespace byre::cli
