#include "byre/cli/shared/recording_options.h"

#include <string>
#include <vector>

#include <CLI/CLI.hpp>
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

}  // namespace
}  // namespace byre::cli
