// KITTI odometry 00 (Geiger 2012), its first 60 rectified stereo pairs: a car drives 55 m along a street.

#include "mapped_recording.h"

#include "byre/io/recording/trajectory_input.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr const char* kSequence = "kitti/sequences/00";

Trajectory part(const Trajectory& trajectory, std::ptrdiff_t first, std::ptrdiff_t last) {
  return {trajectory.begin() + first, trajectory.begin() + last + 1};
}

class Kitti00 : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_recording(kSequence)) GTEST_SKIP() << missing(kSequence);
  }

  static const MappedRecording& inline_run() {
    static const MappedRecording mapped = map_recording(*find_recording(kSequence), {}, make_inline_executor());
    return mapped;
  }
};

TEST_F(Kitti00, EveryFrameHasAPose) {
  EXPECT_EQ(inline_run().frame_times.size(), 60);
  EXPECT_EQ(frames_without_pose(inline_run()), 0);
}

// Evaluates frames 17 to 38 only, where the truth is smooth. Its first 17 poses have a constant step of 0.859 m,
// although the images show an acceleration from 0.68 m per frame, and it jumps at frames 39 to 45.
TEST_F(Kitti00, FinalTrajectoryIsAccurateToCentimetresOnSmoothTruth) {
  ASSERT_EQ(frames_without_pose(inline_run()), 0);
  EXPECT_LE(position_error(part(inline_run().final, 17, 38), load_truth(*find_recording(kSequence))), 0.03);
}

}  // namespace
}  // namespace byre
