#include "byre/playback/map_from_poses_run.h"

#include "byre/input_error.h"
#include "byre/map/map_file.h"
#include "byre/playback/frame_source.h"

namespace byre {

PosedRun run_map_from_poses(Recording& recording, const Trajectory& world_from_body, const ExtractOptions& extract,
                            const PosedRunHooks& hooks) {
  constexpr Timestamp kMaxGap = std::chrono::milliseconds(100);  // between poses that are interpolated
  Extractor extractor(recording.calibration(), extract);
  DecodeAhead decoder(recording);
  PosedRun run;
  std::vector<PosedFrame> frames;
  while (std::optional<DecodedFrame> decoded = decoder.next()) {
    if (hooks.should_stop()) break;
    run.warnings.insert(run.warnings.end(), decoded->warnings.begin(), decoded->warnings.end());
    ++run.frames;
    const std::optional<Pose> pose = pose_at(world_from_body, decoded->time, kMaxGap);
    run.without_pose += pose ? 0 : 1;
    run.unreadable += decoded->images ? 0 : 1;
    if (pose && decoded->images) {
      frames.push_back({extractor.extract(*decoded->images).frame, inverse(*pose * extractor.rig().body_from_camera)});
      run.trajectory.push_back({decoded->time, *pose});
    }
    hooks.after_frame(run.frames);
  }
  if (frames.empty() && run.without_pose > 0) {
    throw InputError("trajectory", "has no pose at the time of any frame of the recording",
                     "check that the times of both have the same epoch");
  }
  run.map = offline_copy(map_from_poses({extractor.rig()}, frames, {}));
  return run;
}

}  // namespace byre
