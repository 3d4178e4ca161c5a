#include "byre/playback/play.h"

#include "byre/base/stopwatch.h"
#include "byre/odometry/recorded_motion.h"
#include "byre/playback/frame_source.h"
#include "byre/playback/missing_poses.h"
#include "byre/slam/system/resources.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

bool has_pose(const PlayedFrame& frame) {
  return frame.report && frame.report->map_from_body;
}

// A frame that slam drops has no report, like one with unreadable images.
PlayedFrame process_frame(SlamImpl& slam, const DecodedFrame& decoded) {
  PlayedFrame frame;
  frame.time = decoded.time;
  if (decoded.images) {
    FrameReport report = slam.process(*decoded.images);
    frame.has_right = decoded.images->right.has_value();
    frame.has_depth = decoded.images->depth.has_value();
    frame.seconds = slam.seconds();
    if (!is_dropped(report.input)) frame.report = std::move(report);
  }
  frame.seconds.decode = decoded.seconds;
  frame.keyframes = slam.online().keyframe_count();
  frame.points = slam.online().point_count();
  frame.memory_mb = resident_memory_mb();
  return frame;
}

// Passes on motion samples up to a frame, in the order of a live robot.
class MotionFeed {
 public:
  explicit MotionFeed(const MotionSamples& samples) : samples_(samples) {}

  void feed(SlamImpl& slam, Timestamp until) {
    for (; wheel_ < samples_.wheels.size() && samples_.wheels[wheel_].time <= until; ++wheel_) {
      slam.add_wheel_odometry(samples_.wheels[wheel_]);
    }
    for (; velocity_ < samples_.velocities.size() && samples_.velocities[velocity_].time <= until; ++velocity_) {
      slam.add_wheel_odometry(samples_.velocities[velocity_]);
    }
    for (; rate_ < samples_.rates.size() && samples_.rates[rate_].time <= until; ++rate_) {
      slam.add_gyro(samples_.rates[rate_]);
    }
    for (const auto& samples = samples_.accelerations; acceleration_ < samples.size(); ++acceleration_) {
      if (samples[acceleration_].time > until) break;
      slam.add_accel(samples[acceleration_]);
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
void note_jobs(const SlamImpl& slam, RunResult& run, std::size_t noted = 0) {
  const std::vector<double>& seconds = slam.log().job_seconds;
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

// Final poses of all located frames; those of a finished map include frames located in it afterwards.
Trajectory located_frames(SlamImpl& slam, FrameSource& frames, const PlayHooks& hooks, RunResult& run) {
  const Trajectory seen = slam.session().final_trajectory();
  constexpr double kOtherCamera = 3.0;  // pixels by which the calibration changed since frames were tracked
  if (!run.finishing || seen.empty()) return seen;
  const auto refined = slam.calibration();
  const bool is_other_camera = refined && !refined->was_refused() && refined->shift > kOtherCamera;
  if (seen.size() == run.frames.size() && !is_other_camera) return seen;
  FramesAgain again;
  for (const PlayedFrame& frame : run.frames) again.times.push_back(frame.time);
  again.read = [&](int number) {
    return run.frames[static_cast<std::size_t>(number)].report ? frames.read_again(number) : std::nullopt;
  };
  again.should_stop = hooks.should_stop;
  const auto announce = [&](const char* step) {
    if (hooks.before_finishing_step) hooks.before_finishing_step(step);
  };
  Trajectory found = seen;
  if (is_other_camera) {
    announce("locating frames by the refined calibration");
    found = located_again(slam, seen, again);
  }
  announce("locating frames without a pose");
  Trajectory all = with_missing_poses(slam, found, again);
  std::vector<Timestamp> located;
  for (const StampedPose& pose : all) {
    if (!std::ranges::binary_search(seen, pose.time, {}, &StampedPose::time)) located.push_back(pose.time);
  }
  run.located_afterwards = static_cast<int>(located.size());
  if (located.empty()) return all;
  return slam.refine_by_located(std::move(all), located);
}

void collect_results(SlamImpl& slam, const Trajectory& seen, RunResult& run) {
  run.final = slam.with_filled_gaps(seen);
  run.offline = slam.inputs().offline;
  run.calibration = slam.calibration();
  run.row_error = slam.row_error().pixels();
  run.motion = motion_estimates(slam.prior(), slam.session());
  run.motion.scale_sigma = slam.scale_sigma();
  run.motion.is_scaled_by_tags = slam.is_scaled_by_tags();
  run.is_metric = slam.is_metric();
  run.stored = slam.take_stored_map();
  if (run.finishing) run.finishing->faults = find_faults(run.stored.map);
  if (!run.offline) run.not_joined = slam.session().frames_not_joined();
  std::erase_if(run.not_joined,
                [&](Timestamp time) { return std::ranges::binary_search(seen, time, {}, &StampedPose::time); });
  if (slam.inputs().maps.size() < 2) run.motion.filled_poses = static_cast<int>(run.final.size() - seen.size());
  for (const PlayedFrame& frame : run.frames) {
    if (has_pose(frame)) run.causal.push_back({frame.time, *frame.report->map_from_body});
    if (frame.report && frame.report->odometry_from_body) {
      run.odometry.push_back({frame.time, *frame.report->odometry_from_body});
    }
  }
}

// Each step needs about as much memory as all earlier ones, in other block sizes.
FinishHooks release_memory_between_steps(const PlayHooks& hooks) {
  return {hooks.should_stop, [announce = hooks.before_finishing_step](const char* step) {
            release_free_memory();
            if (announce) announce(step);
          }};
}

RunResult run_through(SlamImpl& slam, FrameSource& frames, const PlayHooks& hooks) {
  const Stopwatch watch;
  MotionFeed feed(frames.motion());
  if (const auto& axes = frames.motion().left_from_gyroscope) slam.set_gyro_extrinsics(*axes);
  RunResult run;
  bool is_begun = false;
  while (const auto frame = frames.next(hooks.should_stop)) {
    if (frame->late_s > 0.0) run.lateness.push_back(frame->late_s);
    if (hooks.should_stop()) break;
    const DecodedFrame& decoded = frame->decoded;
    run.warnings.insert(run.warnings.end(), decoded.warnings.begin(), decoded.warnings.end());
    feed.feed(slam, decoded.time);
    run.frames.push_back(process_frame(slam, decoded));
    if (decoded.images && !run.frames.back().report) {
      run.warnings.push_back(
          fmt::format("frame {} is skipped: {}", run.frames.size() - 1, to_string(slam.input().last())));
    }
    note_jobs(slam, run);
    hooks.after_frame(static_cast<int>(run.frames.size()), run.frames.back());
    if (hooks.on_frame && run.frames.back().report)
      hooks.on_frame({*decoded.images, run.frames.back(), slam.session()});
    is_begun = is_begun || (has_pose(run.frames.back()) && slam.online().keyframe_count() > 0);
    if (is_begun && hooks.on_map_update) hooks.on_map_update(slam);
    if (slam.map_damage() != nullptr) break;
  }
  const std::size_t noted_jobs = slam.log().job_seconds.size();
  const std::optional<FinishResult> finishing = slam.finish(release_memory_between_steps(hooks));
  if (finishing && slam.inputs().offline) run.mission_finishing_seconds = finishing->seconds;
  if (finishing && !slam.inputs().offline) run.finishing = finishing;
  note_jobs(slam, run, noted_jobs);
  run.motion_warnings = slam.warnings();
  if (!run.frames.empty()) {
    const auto clocks = clock_warnings(frames.motion(), run.frames.front().time, run.frames.back().time);
    run.motion_warnings.insert(run.motion_warnings.end(), clocks.begin(), clocks.end());
  }
  collect_results(slam, located_frames(slam, frames, hooks, run), run);
  if (const InputError* const damage = slam.map_damage()) run.map_damage = *damage;
  run.wall_seconds = watch.seconds();
  return run;
}

}  // namespace

RunResult play(Slam& slam, FrameSource& frames, const PlayHooks& hooks) {
  RunResult run = run_through(slam.impl(), frames, hooks);
  release_free_memory();
  return run;
}

RunResult play(Slam& slam, Recording& recording, const PlayHooks& hooks) {
  RecordingFrames frames(recording, slam.impl().options().pace == Pace::live);
  return play(slam, frames, hooks);
}

Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration) {
  for (StampedPose& sample : trajectory) sample.world_from_body = plan_from_body(registration, sample.world_from_body);
  return trajectory;
}

PlayedFrame on_plan(PlayedFrame frame, const PlanRegistration& registration) {
  if (!frame.report || !frame.report->map_from_body) return frame;
  FrameReport& report = *frame.report;
  report.covariance = covariance_on_plan(registration, *report.map_from_body, report.covariance);
  report.map_from_body = plan_from_body(registration, *report.map_from_body);
  return frame;
}

RunResult on_plan(RunResult run, const PlanRegistration& registration) {
  run.causal = on_plan(std::move(run.causal), registration);
  run.final = on_plan(std::move(run.final), registration);
  for (PlayedFrame& frame : run.frames) frame = on_plan(std::move(frame), registration);
  return run;
}

}  // namespace byre
