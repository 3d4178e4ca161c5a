// EuRoC MH_01_easy (Burri 2016), its 300 stereo pairs from 5 s to 20 s: a drone moved by hand inside a cube of 0.6 m.

#include "mapped_recording.h"

#include "byre/io/recording/trajectory_input.h"

#include <filesystem>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

constexpr const char* kRecordingName = "euroc/MH_01_easy";
constexpr int kLatency = 4;  // frames that a mapping job takes

MappedRecording map_all(std::unique_ptr<Executor> executor) {
  return map_recording(*find_recording(kRecordingName), {}, std::move(executor));
}

// The truth's clock is late by about 7.5 ms; this correction shows the error without it.
AssociationOptions corrected_clock() {
  AssociationOptions options;
  options.time_offset = std::chrono::microseconds(-7500);
  return options;
}

class EurocMh01 : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_recording(kRecordingName)) GTEST_SKIP() << missing(kRecordingName);
    truth_ = load_truth(*find_recording(kRecordingName));
  }

  // The run that most tests evaluate, made once.
  static const MappedRecording& inline_run() {
    static const MappedRecording mapped = map_all(make_inline_executor());
    return mapped;
  }

  double final_error(const MappedRecording& mapped) const { return position_error(mapped.final, truth_); }

  Trajectory truth_;
};

TEST_F(EurocMh01, EveryFrameHasAPose) {
  EXPECT_EQ(inline_run().frame_times.size(), 300);
  EXPECT_EQ(frames_without_pose(inline_run()), 0);
}

TEST_F(EurocMh01, FinalTrajectoryIsAccurateToMillimetres) {
  EXPECT_LE(final_error(inline_run()), 0.0046);
  EXPECT_LE(position_error(inline_run().final, truth_, corrected_clock()), 0.0033);
}

TEST_F(EurocMh01, CausalTrajectoryIsNearlyAsAccurate) {
  EXPECT_EQ(inline_run().causal.size(), 300);
  EXPECT_LE(position_error(inline_run().causal, truth_), 0.006);
}

// Creates the recording of `source` with the images of the two cameras exchanged.
void exchange_image_folders(const std::filesystem::path& source, const std::filesystem::path& folder) {
  for (const auto& [camera, other] : {std::pair("cam0", "cam1"), std::pair("cam1", "cam0")}) {
    const std::filesystem::path from = source / "mav0", to = folder / "mav0" / camera;
    std::filesystem::create_directories(to);
    std::filesystem::copy_file(from / camera / "sensor.yaml", to / "sensor.yaml");
    std::filesystem::copy_file(from / other / "data.csv", to / "data.csv");
    std::filesystem::create_directory_symlink(std::filesystem::absolute(from / other / "data"), to / "data");
  }
}

TEST_F(EurocMh01, HasTheSamePosesWithExchangedImageFolders) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("byre_exchanged." + std::to_string(getpid()));
  exchange_image_folders(*find_recording(kRecordingName), folder);
  const FrameRange start{.last = 60};
  const MappedRecording exchanged = map_recording(folder, start, make_inline_executor());
  const MappedRecording right = map_recording(*find_recording(kRecordingName), start, make_inline_executor());
  std::filesystem::remove_all(folder);
  ASSERT_EQ(right.causal.size(), 60U);
  EXPECT_EQ(written(exchanged.causal), written(right.causal));
  EXPECT_EQ(written(exchanged.final), written(right.final));
}

// Determinism on real images. Session.IsDeterministic* tests it on simulated features, MapProgram on rendered images.
using LongRunEurocMh01 = EurocMh01;

TEST_F(LongRunEurocMh01, InlineMappingIsDeterministic) {
  const MappedRecording again = map_all(make_inline_executor());
  EXPECT_TRUE(written(again.final) == written(inline_run().final));
  EXPECT_TRUE(written(again.causal) == written(inline_run().causal));
}

TEST_F(LongRunEurocMh01, PacedMappingIsDeterministic) {
  const MappedRecording once = map_all(make_paced_executor(kLatency));
  const MappedRecording again = map_all(make_paced_executor(kLatency));
  EXPECT_TRUE(written(again.final) == written(once.final));
  EXPECT_TRUE(written(again.causal) == written(once.causal));
}

TEST_F(EurocMh01, PacedMappingIsNearlyAsAccurate) {
  const MappedRecording mapped = map_all(make_paced_executor(kLatency));
  EXPECT_EQ(frames_without_pose(mapped), 0);
  EXPECT_LE(final_error(mapped), 1.5 * final_error(inline_run()));
}

// Frames are fed without pause, faster than the camera's rate.
TEST_F(EurocMh01, LiveMappingIsNearlyAsAccurate) {
  const MappedRecording live = map_all(make_live_executor());
  EXPECT_EQ(frames_without_pose(live), 0);
  EXPECT_LE(final_error(live), 1.5 * final_error(inline_run()));
}

TEST_F(EurocMh01, EveryThirdFrameSuffices) {
  FrameRange range;
  range.stride = 3;
  const MappedRecording mapped = map_recording(*find_recording(kRecordingName), range, make_inline_executor());
  EXPECT_EQ(mapped.frame_times.size(), 100);
  EXPECT_EQ(frames_without_pose(mapped), 0);
  EXPECT_LE(final_error(mapped), 0.006);
}

}  // namespace
}  // namespace byre
