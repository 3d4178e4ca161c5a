// A rendered recording at half of EuRoC's resolution with exact truth: tests the way from image files to a trajectory
// without external data.

#include "mapped_recording.h"

#include "byre/io/recording/trajectory_input.h"
#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_trajectory_scene.h"

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 80;

class RenderedRoomRecording : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::path(testing::TempDir()) / ("byre_rendered_room." + std::to_string(getpid()));
    const Calibration calibration = euroc_like_calibration(2);
    const Trajectory truth = figure_eight_trajectory(kFrames, 20.0, 3.0, 0.4, calibration.body_from_left);
    write_euroc_recording(RenderedRoom({}), calibration, truth, folder_, {});
    mapped_ = map_recording(folder_, {}, make_inline_executor());
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static inline fs::path folder_;
  static inline MappedRecording mapped_;
};

TEST_F(RenderedRoomRecording, EveryFrameHasAPose) {
  EXPECT_EQ(mapped_.frame_times.size(), kFrames);
  EXPECT_EQ(frames_without_pose(mapped_), 0);
}

TEST_F(RenderedRoomRecording, TrajectoriesAreAccurateToMillimetres) {
  const Trajectory truth = load_truth(folder_);
  EXPECT_LE(position_error(mapped_.final, truth), 0.0035);
  EXPECT_LE(position_error(mapped_.causal, truth), 0.0035);
}

}  // namespace
}  // namespace byre
