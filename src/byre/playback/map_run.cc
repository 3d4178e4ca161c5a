#include "byre/playback/map_run.h"

#include "byre/base/stopwatch.h"
#include "byre/odometry/recorded_motion.h"
#include "byre/playback/frame_source.h"
#include "byre/slam/system/resources.h"

#include <utility>

namespace byre {
namespace {

bool has_pose(const MappedFrame& frame) {
  return frame.report && frame.report->map_from_body;
}

MappedFrame process_frame(Engine& engine, const DecodedFrame& decoded) {
  MappedFrame frame;
  frame.time = decoded.time;
  if (decoded.images) {
    Engine::Processed processed = engine.process(*decoded.images);
    frame.has_right = decoded.images->right.has_value();
    frame.has_depth = decoded.images->depth.has_value();
    frame.report = std::move(processed.report);
    frame.seconds = processed.seconds;
  }
  frame.seconds.decode = decoded.seconds;
  frame.keyframes = engine.online().keyframe_count();
  frame.points = engine.online().point_count();
  frame.memory_mb = resident_memory_mb();
  return frame;
}

// Passes on motion samples up to a frame, in the order of a live robot.
class MotionFeed {
 public:
  explicit MotionFeed(const MotionSamples& samples) : samples_(samples) {}

  void feed(Engine& engine, Timestamp until) {
    for (; wheel_ < samples_.wheels.size() && samples_.wheels[wheel_].time <= until; ++wheel_) {
      engine.add_wheel_odometry(samples_.wheels[wheel_]);
    }
    for (; velocity_ < samples_.velocities.size() && samples_.velocities[velocity_].time <= until; ++velocity_) {
      engine.add_wheel_odometry(samples_.velocities[velocity_]);
    }
    for (; rate_ < samples_.rates.size() && samples_.rates[rate_].time <= until; ++rate_) {
      engine.add_gyro(samples_.rates[rate_]);
    }
    for (const auto& samples = samples_.accelerations; acceleration_ < samples.size(); ++acceleration_) {
      if (samples[acceleration_].time > until) break;
      engine.add_accel(samples[acceleration_]);
    }
  }

 private:
  const MotionSamples& samples_;
  std::size_t wheel_ = 0;
  std::size_t velocity_ = 0;
  std::size_t rate_ = 0;
  std::size_t acceleration_ = 0;
};

// Adds jobs finished since the current frame began, except those noted before.
void note_jobs(const Engine& engine, MapRun& run, std::size_t noted = 0) {
  const std::vector<double>& seconds = engine.log().job_seconds;
  run.job_seconds.insert(run.job_seconds.end(), seconds.begin() + static_cast<std::ptrdiff_t>(noted), seconds.end());
}

MotionEstimates motion_estimates(const OdometryCalibrator& prior, const Session& session) {
  MotionEstimates motion;
  motion.has_samples = !prior.is_empty();
  motion.wheels = prior.wheels();
  motion.gyroscope = prior.gyroscope();
  motion.time_offset = prior.time_offset();
  motion.slips = prior.slips();
  motion.has_calibration_changed = prior.has_calibration_changed();
  motion.calibration_to_store = prior.calibration_to_store();
  motion.stops = prior.stationary().stops();
  motion.standstill_s = prior.stationary().seconds();
  motion.tilts_applied = session.tilts_applied();
  return motion;
}

void collect_results(Engine& engine, MapRun& run) {
  const Trajectory seen = engine.session().final_trajectory();
  run.final = engine.prior().fill_gaps(seen);
  run.calibration = engine.calibration();
  run.row_error = engine.row_error().pixels();
  run.motion = motion_estimates(engine.prior(), engine.session());
  run.motion.scale_sigma = engine.wheel_scale_sigma();
  run.is_metric = engine.is_metric();
  run.map = engine.take_map_to_save();
  if (run.finishing) run.finishing->faults = find_faults(run.map);
  run.motion.filled_poses = static_cast<int>(run.final.size() - seen.size());
  for (const MappedFrame& frame : run.frames) {
    if (has_pose(frame)) run.causal.push_back({frame.time, *frame.report->map_from_body});
    if (frame.report && frame.report->odometry_from_body) {
      run.odometry.push_back({frame.time, *frame.report->odometry_from_body});
    }
  }
}

// Each step needs about as much memory as all earlier ones, in other block sizes.
FinishHooks release_memory_between_steps(const MapRunHooks& hooks) {
  return {hooks.should_stop, [announce = hooks.before_finishing_step](const char* step) {
            release_free_memory();
            if (announce) announce(step);
          }};
}

MapRun run_through(FrameSource& frames, const EngineOptions& options, const MapRunHooks& hooks,
                   std::optional<Map> before) {
  const Stopwatch watch;
  Engine engine(frames.calibration(), options, std::move(before));
  MotionFeed feed(frames.motion());
  if (const auto& axes = frames.motion().left_from_gyroscope) engine.set_gyro_extrinsics(*axes);
  MapRun run;
  bool is_begun = false;
  while (const auto frame = frames.next(hooks.should_stop)) {
    if (frame->late_s > 0.0) run.lateness.push_back(frame->late_s);
    if (hooks.should_stop()) break;
    const DecodedFrame& decoded = frame->decoded;
    run.warnings.insert(run.warnings.end(), decoded.warnings.begin(), decoded.warnings.end());
    feed.feed(engine, decoded.time);
    run.frames.push_back(process_frame(engine, decoded));
    note_jobs(engine, run);
    hooks.after_frame(static_cast<int>(run.frames.size()), run.frames.back());
    if (hooks.on_frame && decoded.images) hooks.on_frame({*decoded.images, run.frames.back(), engine.session()});
    is_begun = is_begun || (has_pose(run.frames.back()) && engine.online().keyframe_count() > 0);
    if (is_begun && hooks.on_map_update) hooks.on_map_update(engine.online(), engine.saved_estimates());
    if (engine.map_damage() != nullptr) break;
  }
  const std::size_t noted_jobs = engine.log().job_seconds.size();
  if (hooks.should_stop() || engine.map_damage() != nullptr) engine.finish_early();
  engine.finish();
  const FinishHooks finish_hooks = release_memory_between_steps(hooks);
  if (is_begun && !hooks.should_stop() && engine.map_damage() == nullptr) {
    if (options.offline) {
      run.mission_finishing_seconds = engine.finish_mission(finish_hooks);
    } else if (options.vocabulary) {
      run.finishing = engine.finish_map(finish_hooks);
    }
  }
  note_jobs(engine, run, noted_jobs);
  run.motion_warnings = engine.warnings();
  if (!run.frames.empty()) {
    const auto clocks = clock_warnings(frames.motion(), run.frames.front().time, run.frames.back().time);
    run.motion_warnings.insert(run.motion_warnings.end(), clocks.begin(), clocks.end());
  }
  collect_results(engine, run);
  if (const InputError* const damage = engine.map_damage()) run.map_damage = *damage;
  run.wall_seconds = watch.seconds();
  return run;
}

}  // namespace

MapRun run_map(Recording& recording, const EngineOptions& options, const MapRunHooks& hooks,
               std::optional<Map> before) {
  RecordingFrames frames(recording, options.pace == Pace::live);
  return run_map(frames, options, hooks, std::move(before));
}

MapRun run_map(FrameSource& frames, const EngineOptions& options, const MapRunHooks& hooks, std::optional<Map> before) {
  MapRun run = run_through(frames, options, hooks, std::move(before));
  release_free_memory();
  return run;
}

}  // namespace byre
