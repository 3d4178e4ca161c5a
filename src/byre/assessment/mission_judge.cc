#include "byre/assessment/mission_judge.h"

#include "byre/map/keyframe_path.h"

namespace byre {
namespace {

MapAlignment align_map(const Map& map, const MissionTruth& truth) {
  return align_to_truth(truth.map_run ? *truth.map_run : keyframe_path(map), truth.map_scale, truth.of_map);
}

}  // namespace

MissionOutcome judge_mission(const MapRun& run, const EngineOptions& options, const std::optional<MissionTruth>& truth,
                             const ScaledRecording& recording) {
  MissionOutcome mission;
  mission.statistics = summarise_mission(run.frames, options.session.mission.view.min_inliers);
  if (!truth) return mission;
  mission.errors = options.offline ? mission_errors(run, align_map(options.offline->map(), *truth), truth->of_frames)
                                   : aligned_errors(run, recording.path_of(truth->of_frames),
                                                    recording.is_metric ? Scale::fixed : Scale::free);
  return mission;
}

}  // namespace byre
