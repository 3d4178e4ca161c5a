#include "byre/slam/session/robot_state.h"

#include <utility>

namespace byre {

RobotState::RobotState(const Rig& rig_of_frames, const SessionOptions& options, std::optional<Vocabulary> vocabulary,
                       std::shared_ptr<const OfflineMap> offline)
    : rig(rig_of_frames),
      mapper(rig, mapper_options(options), std::move(vocabulary), offline),
      tracker(options),
      pose_filter(options.mission.registration, options.deferred_refinement, options.trajectory, offline != nullptr),
      image_monitor(options.image),
      rolling_shutter(rig.readout_time),
      trusted_place(options.mission.registration.max_speed) {
  if (!offline) return;
  mission.emplace(std::move(offline), OfflineTrackerOptions{options.mission, options.track, options.relocalise,
                                                            options.local_keyframes, options.is_planar});
}

JobState* RobotState::job(JobKind kind) {
  switch (kind) {
    case JobKind::local:
      return &mapper.local_job();
    case JobKind::index:
      return &mapper.index_job();
    case JobKind::whole_map:
      return &mapper.map_job();
    case JobKind::place_search:
      return mission ? &mission->search_job() : nullptr;
    case JobKind::calibration:
      return mission ? mission->calibration_job() : nullptr;
  }
  return nullptr;
}

}  // namespace byre
