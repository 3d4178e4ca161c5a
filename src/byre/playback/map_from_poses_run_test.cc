#include "byre/playback/map_from_poses_run.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/simulation/rendered_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

PosedRun run(const std::filesystem::path& folder, const Trajectory& poses, FrameRange range = {}) {
  const auto recording = open_recording(folder, range);
  return run_map_from_poses(*recording, poses, {}, {[] { return false; }, [](int) {}});
}

TEST(RunMapFromPoses, MakesAKeyframeAtEveryGivenPose) {
  const RenderedFixture& rendered = RenderedFixture::shared();
  const PosedRun made = run(rendered.folder(), rendered.truth(), {.stride = 4});
  EXPECT_THAT(find_faults(made.map), IsEmpty());
  EXPECT_EQ(made.frames, 6);
  ASSERT_EQ(made.map.keyframe_count(), 6);
  EXPECT_GT(made.map.point_count(), 200);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const Keyframe& keyframe = *made.map.find_keyframe({Origin::offline, i});
    const Pose body_from_camera = made.map.rigs().front().body_from_camera;
    const StampedPose& truth = rendered.truth()[4 * i];
    EXPECT_EQ(keyframe.frame.time, truth.time);
    EXPECT_THAT(inverse(body_from_camera * keyframe.camera_from_world), PoseNear(truth.world_from_body, 1e-9, 1e-9));
  }
}

TEST(RunMapFromPoses, SkipsFramesWithoutPose) {
  const RenderedFixture& rendered = RenderedFixture::shared();
  const Trajectory second_half(rendered.truth().begin() + 12, rendered.truth().end());
  const PosedRun made = run(rendered.folder(), second_half, {.stride = 4});
  EXPECT_EQ(made.frames, 6);
  EXPECT_EQ(made.without_pose, 3);
  EXPECT_EQ(made.map.keyframe_count(), 3);
  EXPECT_THAT(made.trajectory, SizeIs(3));
}

TEST(RunMapFromPoses, RejectsATrajectoryOfAnotherTime) {
  const RenderedFixture& rendered = RenderedFixture::shared();
  const Trajectory elsewhere = {{std::chrono::hours(1), {}}, {std::chrono::hours(2), {}}};
  EXPECT_THROW(run(rendered.folder(), elsewhere), InputError);
}

}  // namespace
}  // namespace byre
