#include "byre/cli/shared/options.h"
#include "byre/cli/shared/program_fixture.h"
#include "byre/input_error.h"

#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre::cli {
namespace {

OpenOptions parsed(const std::string& arguments) {
  CLI::App command;
  OpenOptions options;
  declare_open_options(command, options);
  command.parse(arguments);
  return options;
}

TEST(OpenOptions, AreUnsetUnlessGiven) {
  const OpenOptions options = parsed("");
  EXPECT_FALSE(options.camera);
  EXPECT_FALSE(options.calibration);
  EXPECT_FALSE(options.frame_rate_hz);
}

TEST(OpenOptions, AreParsed) {
  const OpenOptions options = parsed("--camera right --calibration camchain.yaml --fps 20");
  EXPECT_EQ(options.camera, CameraChoice::right);
  EXPECT_EQ(options.calibration, "camchain.yaml");
  EXPECT_EQ(options.frame_rate_hz, 20.0);
}

TEST(OpenOptions, TakeTwoCalibrationFiles) {
  using Arguments = std::vector<std::string>;
  EXPECT_EQ(with_right_calibration({"map", "--calibration", "left.yaml", "right.yaml", "walk"}),
            (Arguments{"map", "--calibration", "left.yaml", "--right-calibration", "right.yaml", "walk"}));
  for (const Arguments& one :
       {Arguments{"map", "--calibration", "left.yaml", "walk"}, Arguments{"map", "walk", "--calibration", "left.yaml"},
        Arguments{"map", "--calibration", "left.yaml", "--options", "mine.yaml", "walk"}}) {
    EXPECT_EQ(with_right_calibration(one), one);
  }
  EXPECT_EQ(parsed("--calibration left.yaml --right-calibration right.yaml").right_calibration, "right.yaml");
}

TEST(OpenOptions, AreRejectedIfInvalid) {
  for (const char* const arguments : {"--camera", "--camera middle", "--camera 1", "--camera Left", "--fps 0",
                                      "--fps -5", "--fps fast", "--fps nan"}) {
    EXPECT_THROW(parsed(arguments), CLI::ParseError) << arguments;
  }
}

TEST(PoseFrame, OfAPlanIsRejectedForAnUnregisteredMap) {
  EXPECT_THROW(require_plan(std::nullopt, "barn.byre"), InputError);
  PlanRegistration registration;
  registration.plan_from_map.scale = 2.0;
  EXPECT_EQ(require_plan(registration, "barn.byre").plan_from_map.scale, 2.0);
}

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kCamera =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [461, 460, 362, 246]\n  distortion_model: radtan\n"
    "  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [752, 480]\n";
constexpr const char* kAhead = "base_from_camera: {translation_m: [0.4, 0, 0.9], rpy_deg: [-90, 0, -90]}\n";
constexpr const char* kBehind = "base_from_camera: {translation_m: [-0.4, 0, 0.9], rpy_deg: [-90, 0, 90]}\n";

class ExtrinsicsOnCommandLine : public ProgramTest {
 protected:
  ExtrinsicsOnCommandLine() {
    write("plain.yaml", kCamera);
    write("calibration.yaml", std::string(kCamera) + kAhead);
    write("robot.yaml", kBehind);
  }

  ExtrinsicsArguments parsed(const std::string& arguments) const {
    CLI::App command;
    ExtrinsicsArguments extrinsics;
    declare_extrinsics(command, extrinsics);
    command.parse(arguments);
    return extrinsics;
  }

  static std::string error_of(const ExtrinsicsArguments& extrinsics, const OpenOptions& open) {
    try {
      extrinsics.read(open);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  OpenOptions calibrated_by(const std::string& name) const {
    OpenOptions open;
    open.calibration = folder_ / name;
    return open;
  }
};

TEST_F(ExtrinsicsOnCommandLine, AreThoseOfTheCalibrationUnlessGiven) {
  const auto camera_ahead = [](const std::optional<Extrinsics>& extrinsics) {
    return extrinsics.value().camera.value().base_from_sensor.translation.x();
  };
  const ExtrinsicsArguments none = parsed("");
  EXPECT_FALSE(none.read({}));
  EXPECT_FALSE(none.read(calibrated_by("plain.yaml")));
  EXPECT_EQ(camera_ahead(none.read(calibrated_by("calibration.yaml"))), 0.4);
  const ExtrinsicsArguments given = parsed("--extrinsics '" + (folder_ / "robot.yaml").string() + "'");
  EXPECT_EQ(camera_ahead(given.read({})), -0.4);
  EXPECT_EQ(camera_ahead(given.read(calibrated_by("calibration.yaml"))), -0.4);
}

TEST_F(ExtrinsicsOnCommandLine, AreFoundInACalibrationGivenAsAFolder) {
  EXPECT_TRUE(parsed("").read(calibrated_by("")));
  std::filesystem::create_directory(folder_ / "pair");
  write("pair/left.yaml", kCamera);
  write("pair/right.yaml", kCamera);
  EXPECT_FALSE(parsed("").read(calibrated_by("pair")));
}

TEST_F(ExtrinsicsOnCommandLine, AreRefusedForTheRightCamera) {
  const ExtrinsicsArguments given = parsed("--extrinsics '" + (folder_ / "robot.yaml").string() + "'");
  OpenOptions open = calibrated_by("calibration.yaml");
  open.camera = CameraChoice::right;
  EXPECT_THAT(error_of(given, open), AllOf(HasSubstr("robot.yaml: has the pose of the left camera"),
                                           HasSubstr("leave out --extrinsics, or use --camera left")));
  EXPECT_THAT(error_of(parsed(""), open), HasSubstr("calibration.yaml: has the pose of the left camera"));
  EXPECT_FALSE(parsed("").read({.camera = CameraChoice::right}));
  open.camera = CameraChoice::left;
  EXPECT_TRUE(given.read(open));
}

TEST_F(ExtrinsicsOnCommandLine, HaveFramesOnlyWithAFile) {
  for (const std::string frame : {"--base-frame base", "--camera-frame eye", "--imu-frame imu"}) {
    EXPECT_THROW(parsed(frame), CLI::RequiresError) << frame;
  }
  const ExtrinsicsArguments given =
      parsed("--extrinsics robot.urdf --base-frame base --camera-frame eye --imu-frame imu");
  EXPECT_EQ(given.file, "robot.urdf");
  EXPECT_EQ(given.frames.base, "base");
  EXPECT_EQ(given.frames.camera, "eye");
  EXPECT_EQ(given.frames.imu, "imu");
}

TEST_F(ExtrinsicsOnCommandLine, NameTheFaultOfTheFile) {
  write("wrong.yaml", "base_from_camera: [0, 0, 1]\n");
  const ExtrinsicsArguments given = parsed("--extrinsics '" + (folder_ / "wrong.yaml").string() + "'");
  EXPECT_THAT(error_of(given, {}), AllOf(HasSubstr("wrong.yaml"), HasSubstr("base_from_camera")));
}

}  // namespace

}  // namespace byre::cli
