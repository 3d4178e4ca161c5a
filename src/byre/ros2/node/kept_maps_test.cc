#include "byre/ros2/node/slam_runner.h"

#include "byre/base/output_file.h"
#include "byre/input_error.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class KeptMaps : public testing::Test {
 protected:
  KeptMaps() { fs::create_directories(folder_); }
  ~KeptMaps() override { fs::remove_all(folder_); }

  static std::string content(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_kept_maps." + std::to_string(getpid()));
  fs::path map_ = folder_ / "barn.byre";
};

const std::string kBegin =
    "\x89"
    "BYRE\r\n";

TEST_F(KeptMaps, AreTheSavedMapAndThreePreviousOnes) {
  keep_as_previous(map_);
  EXPECT_FALSE(fs::exists(previous_map(map_))) << "there was none";
  for (const char* const day : {"friday", "saturday", "sunday", "monday", "tuesday"}) {
    keep_as_previous(map_);
    write_atomically(map_, kBegin + day);
  }
  EXPECT_EQ(content(map_), kBegin + "tuesday");
  EXPECT_EQ(content(folder_ / "barn.previous.byre"), kBegin + "monday");
  EXPECT_EQ(content(folder_ / "barn.previous_2.byre"), kBegin + "sunday");
  EXPECT_EQ(content(folder_ / "barn.previous_3.byre"), kBegin + "saturday");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 4);
}

TEST_F(KeptMaps, LeaveNoFilesAfterASaveInterruptedBeforeReplacement) {
  write_atomically(map_, kBegin + "monday");
  for (int save = 0; save < 2; ++save) keep_as_previous(map_);
  EXPECT_EQ(content(previous_map(map_)), kBegin + "monday");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2);
}

TEST_F(KeptMaps, SurviveLeftoversOfAnInterruptedSave) {
  write_atomically(map_, kBegin + "monday");
  std::ofstream(folder_ / "barn.previous.byre.0123abcd.unfinished") << "half";
  keep_as_previous(map_);
  EXPECT_EQ(content(previous_map(map_)), kBegin + "monday");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2);
}

TEST_F(KeptMaps, LeaveOtherFilesUnchanged) {
  std::ofstream(map_) << "Dear reader";
  keep_as_previous(map_);
  EXPECT_FALSE(fs::exists(previous_map(map_)));
  fs::remove(map_);
  write_atomically(map_, kBegin + "monday");
  std::ofstream(previous_map(map_)) << "Dear reader";
  EXPECT_THROW(keep_as_previous(map_), InputError);
  EXPECT_EQ(content(previous_map(map_)), "Dear reader");
  keep_as_previous("/dev/null");
  EXPECT_FALSE(fs::exists("/dev/null.previous"));
}

std::string refusal_of(const NodeConfig& config) {
  try {
    SlamRunner runner(config);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST_F(KeptMaps, AreRejectedForInputsOfTheNodeAndOtherFileTypes) {
  NodeConfig config;
  config.file = folder_ / "robot.yaml";
  config.map = folder_ / "barn.byre";
  config.calibration = folder_ / "calibration.yaml";
  config.plan = folder_ / "plan.yaml";
  std::ofstream(*config.file) << "slam:\n";
  std::ofstream(*config.calibration) << "cam0:\n";
  std::ofstream(*config.plan) << "image: plan.png\n";
  for (const char* const image : {"plan.png", "photo.png"}) std::ofstream(folder_ / image) << "\x89PNG\r\n";
  write_atomically(*config.map, kBegin);
  fs::create_hard_link(*config.map, folder_ / "same.byre");
  const auto with = [&config, this](const char* name) {
    config.save = folder_ / name;
    return refusal_of(config);
  };
  for (const char* const read : {"robot.yaml", "calibration.yaml", "plan.yaml", "plan.png", "barn.byre", "same.byre"}) {
    EXPECT_THAT(with(read), HasSubstr("cannot be overwritten: choose another file")) << read;
  }
  EXPECT_THAT(with("photo.png"), HasSubstr("exists and is not the expected kind of file (map)"));
  EXPECT_EQ(with("today.byre"), "");
  config.map = folder_ / "today.previous.byre";
  EXPECT_THAT(with("today.byre"), HasSubstr("today.previous.byre is also an input (slam.map)"))
      << "a save would replace it";
  config.map = folder_ / "barn.byre";
  config.task = NodeTask::extend;
  EXPECT_EQ(with("barn.byre"), "") << "a map may be extended in place";
}

}  // namespace
}  // namespace byre
