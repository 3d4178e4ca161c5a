// A real recording of a hand-turned depth camera; one frame in six has a depth image.

#include "mapped_recording.h"

#include "byre/io/recording/trajectory_input.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr const char* kRecording = "tum/freiburg1_rpy";

TEST(DepthCameraInFreiburg1, TracksEveryFrameInMetresWithSparseDepth) {
  const auto folder = find_recording(kRecording);
  if (!folder) GTEST_SKIP() << missing(kRecording);
  const MappedRecording mapped = map_recording(*folder, {}, make_paced_executor(4), {.camera = CameraChoice::rgbd});
  EXPECT_LE(frames_without_pose(mapped), 5);
  // The path spreads 52 mm about its mean while the camera turns, with a rolling shutter.
  EXPECT_LE(position_error(mapped.final, load_truth(*folder)), 0.032);
}

}  // namespace
}  // namespace byre
