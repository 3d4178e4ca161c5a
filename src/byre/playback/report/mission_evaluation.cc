#include "byre/playback/report/mission_evaluation.h"

#include "byre/map/keyframe_path.h"

namespace byre {
namespace {

// Trajectory of the mapping run, converted to the body of the mission's calibration.
Trajectory path_of(const OfflineMap& offline, const std::optional<Trajectory>& map_run, const Calibration& given) {
  Trajectory path = map_run ? *map_run : keyframe_path(offline.map());
  const Pose map_body_from_body = stored_body_from_body(offline.recordings(), given).value_or(Pose{});
  for (StampedPose& pose : path) pose.world_from_body = pose.world_from_body * map_body_from_body;
  return path;
}

}  // namespace

MissionOutcome evaluate_mission(const RunResult& run, const MethodOptions& options,
                                const std::optional<MissionTruth>& truth, const ScaledRecording& recording) {
  MissionOutcome mission;
  mission.statistics = summarise_mission(run.frames, options.session.mission.view.min_inliers);
  if (!truth) return mission;
  if (!run.offline) {
    mission.errors =
        aligned_errors(run, recording.path_of(truth->frames), recording.is_metric ? Scale::fixed : Scale::free);
    return mission;
  }
  const Trajectory path = path_of(*run.offline, truth->map_run, recording.recording->calibration());
  mission.errors = mission_errors(run, align_to_truth(path, truth->map_scale, truth->map), truth->frames);
  return mission;
}

}  // namespace byre
