#include "start_run.h"

#include "aligned_map.h"

#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/map/stored_calibration.h"
#include "byre/slam/places/place_view.h"
#include "byre/slam/system/slam_impl.h"
#include "byre/slam/tracking/body_pose.h"

#include <algorithm>

namespace byre {
namespace {

using Frames = std::vector<std::optional<Frame>>;  // empty for unreadable images

Frames extract_all(Recording& recording, const Calibration& calibration, const Imperfection& imperfection) {
  limit_image_threads(1);
  const Degradation cameras = imperfect_cameras(imperfection);
  Extractor extractor(calibration, {});
  Frames frames;
  for (int i = 0; i < recording.size(); ++i) {
    const auto images = recording.read(i);
    frames.push_back(images ? std::optional(extractor.extract(cameras(*images, i)).frame) : std::nullopt);
  }
  return frames;
}

Frame covered(const Frame& frame) {
  Frame dark = frame;
  dark.features = std::make_shared<const Features>();
  if (dark.condition) dark.condition = ImageCondition{};
  return dark;
}

struct Visit {
  const Recording& recording;
  const Calibration& calibration;
  const Frames& frames;
  const Trajectory& truth;
  std::shared_ptr<const OfflineMap> map;
  const Similarity& truth_from_map;
  const StartPlan& plan;
};

// Adds the samples up to a time, from 0.25 s before the first frame.
template <typename Sample, typename Add>
void feed(const std::vector<Sample>& samples, std::size_t& next, Timestamp begin, Timestamp until, Add add) {
  for (; next < samples.size() && samples[next].time <= until; ++next) {
    if (samples[next].time >= begin - std::chrono::milliseconds(250)) add(samples[next]);
  }
}

std::vector<MissionFrame> run_from(const Visit& visit, std::size_t first) {
  MethodOptions options;
  options.pace = Pace::paced;
  SlamImpl slam(visit.calibration, options, {.vocabulary = mission_vocabulary(), .offline = visit.map});
  const std::vector<Timestamp>& times = visit.recording.times();
  const MotionSamples& motion = visit.recording.motion();
  if (const auto& axes = motion.left_from_gyroscope) slam.set_gyro_extrinsics(*axes);
  const Timestamp begin = times[first];
  std::vector<MissionFrame> frames;
  std::size_t wheel = 0, velocity = 0, rate = 0, acceleration = 0;
  for (std::size_t i = first; i < times.size() && to_seconds(times[i] - begin) < visit.plan.length_s; ++i) {
    if (!visit.frames[i]) continue;
    feed(motion.wheels, wheel, begin, times[i], [&](const auto& sample) { slam.add_wheel_odometry(sample); });
    feed(motion.velocities, velocity, begin, times[i], [&](const auto& sample) { slam.add_wheel_odometry(sample); });
    feed(motion.rates, rate, begin, times[i], [&](const auto& sample) { slam.add_gyro(sample); });
    feed(motion.accelerations, acceleration, begin, times[i], [&](const auto& sample) { slam.add_accel(sample); });
    const double seconds = to_seconds(times[i] - begin);
    const auto& cover = visit.plan.cover_s;
    const bool is_covered = cover && seconds >= cover->first && seconds < cover->second;
    const Frame frame = is_covered ? covered(*visit.frames[i]) : *visit.frames[i];
    frames.push_back({slam.process(frame), pose_at(visit.truth, frame.time, std::chrono::milliseconds(60))});
  }
  return frames;
}

bool is_map_in_view(const Visit& visit, const Rig& rig, const MissionFrame& frame) {
  if (!frame.true_world_from_body) return false;
  const Similarity& truth_from_map = visit.truth_from_map;
  const Pose& truth = *frame.true_world_from_body;
  const Pose map_from_world = inverse(truth_from_map.target_from_source);
  const Pose map_from_body{map_from_world.rotation * truth.rotation,
                           (map_from_world * truth.translation) / truth_from_map.scale};
  const Pose camera_from_map = camera_pose(rig, map_from_body);
  const auto points = points_of_place(*visit.map, keyframes_of_place(*visit.map, camera_from_map));
  const auto in_view = std::ranges::count_if(points, [&](PointId id) {
    const Eigen::Vector3d in_camera = camera_from_map * visit.map->map().find_point(id)->position_in_world;
    if (in_camera.z() <= 0.1) return false;
    const Eigen::Vector3d pixel = rig.project(in_camera);
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() < rig.width && pixel.y() < rig.height;
  });
  return in_view >= kPointsInView;
}

// Whether the map was in view for kMaxTimeToLocalise without a trusted pose.
bool is_localised_late(const Visit& visit, const Rig& rig, const std::vector<MissionFrame>& frames) {
  std::optional<Timestamp> since;
  for (const MissionFrame& frame : frames) {
    if (frame.report.health.verdict == Verdict::trusted) return false;
    if (!is_map_in_view(visit, rig, frame)) {
      since.reset();
      continue;
    }
    if (!since) since = frame.report.time;
    if (to_seconds(frame.report.time - *since) > kMaxTimeToLocalise) return true;
  }
  return false;
}

}  // namespace

void StartTotals::add(const StartedMission& mission) {
  const MissionScore& score = mission.score;
  ++starts;
  frames += score.frames;
  with_pose += static_cast<int>(score.coverage * score.frames + 0.5);
  wrongly_trusted += score.wrongly_trusted;
  correctly_trusted += static_cast<int>(score.trusted * score.frames + 0.5) - score.wrongly_trusted;
  starts_wrongly_trusted += score.wrongly_trusted > 0 ? 1 : 0;
  localised_late += mission.is_localised_late ? 1 : 0;
  worst_trusted_error = std::max(worst_trusted_error, score.worst_trusted_error);
}

StartTotals run_starts(Recording& recording, const Trajectory& truth, std::shared_ptr<const OfflineMap> map,
                       const Similarity& truth_from_map, const Imperfection& imperfection, const StartPlan& plan,
                       const std::function<void(const StartedMission&)>& each) {
  const Calibration nominal = nominal_calibration(recording.calibration(), imperfection);
  const auto known = stored_calibration(map->recordings(), nominal);
  const Calibration& calibration = known ? known->calibration : nominal;
  const Frames frames = extract_all(recording, calibration, imperfection);
  const Rig rig = Extractor(calibration, {}).rig();
  const Visit visit{recording, calibration, frames, truth, std::move(map), truth_from_map, plan};
  StartTotals totals;
  double next = plan.from_s;
  const std::vector<Timestamp>& times = recording.times();
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double seconds = to_seconds(times[i] - times.front());
    if (seconds + 1e-6 < next || seconds > plan.to_s) continue;
    next += plan.every_s;
    StartedMission mission{seconds, run_from(visit, i), {}};
    if (mission.frames.empty()) continue;
    mission.score = score(mission.frames, truth_from_map, mission.frames.front().report.time);
    mission.is_localised_late = is_localised_late(visit, rig, mission.frames);
    totals.add(mission);
    if (each) each(mission);
  }
  return totals;
}

}  // namespace byre
