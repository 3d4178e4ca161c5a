#include "byre/slam/system/engine.h"

#include "byre/base/stopwatch.h"
#include "byre/map/stored_calibration.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

constexpr double kMillisecondsPerSecond = 1e3;

// The second lane of a mission searches places in the offline map. Paced reading of the map ends before the next frame
// modifies it.
SessionExecutors make_lanes(Pace pace, bool is_mission, JobLog& log) {
  switch (pace) {
    case Pace::same_thread:
      return {make_logged_executor(make_inline_executor(), log), make_inline_executor()};
    case Pace::paced:
      return {make_logged_executor(make_paced_executor(kPacedLatency), log),
              make_paced_executor(is_mission ? kPacedSearchLatency : kPacedCorrectionLatency), make_inline_executor(),
              make_paced_executor(1)};
    case Pace::live:
      return {make_logged_executor(make_live_executor(), log), make_live_executor(), make_inline_executor(),
              make_live_executor()};
  }
  return {nullptr, nullptr};
}

std::optional<RefinedCalibration> initial_calibration(const Calibration& given, const EngineOptions& options) {
  if (options.refined_calibration || !options.offline) return options.refined_calibration;
  return stored_calibration(options.offline->recordings(), given);
}

OdometryCalibration initial_extrinsics(const Calibration& given, const EngineOptions& options) {
  if (!options.use_saved_extrinsics) return {};
  if (!options.offline) return options.extrinsics;
  return odometry_calibration_for(options.offline->extrinsics(), options.offline->recordings(), given);
}

// Other cameras than those of the map may be mounted at another height or tilt.
SessionOptions session_options(const Calibration& given, const EngineOptions& options) {
  SessionOptions session = options.session;
  const bool has_recordings = options.offline && !options.offline->recordings().empty();
  if (has_recordings && !has_same_cameras(options.offline->recordings(), given)) {
    session.mission.bounds.is_on_ground_of_map = false;
  }
  return session;
}

}  // namespace

std::string_view name_of(Pace pace) {
  switch (pace) {
    case Pace::same_thread:
      return "inline";
    case Pace::paced:
      return "paced";
    case Pace::live:
      return "live";
  }
  return "";
}

std::string_view name_of(OfflinePolicy policy) {
  switch (policy) {
    case OfflinePolicy::first:
      return "first";
    case OfflinePolicy::together:
      return "together";
  }
  return "";
}

Engine::Engine(const Calibration& given, const EngineOptions& options, std::optional<Map> before)
    : offline_(options.offline),
      body_from_left_(given.body_from_left.rotation),
      initial_calibration_(initial_calibration(given, options)),
      extractor_(initial_calibration_ ? initial_calibration_->calibration : given, options.extract),
      prior_(options.motion_limits),
      is_metric_(given.is_metric() || options.offline || before),
      min_scale_sigma_(options.wheel_scale_sigma),
      budget_(options.frame_deadline_ms / kMillisecondsPerSecond),
      session_(extractor_.rig(), session_options(given, options),
               make_lanes(options.pace, options.offline != nullptr, log_), options.vocabulary, options.offline) {
  prior_.begin_with(initial_extrinsics(given, options));
  const Eigen::Quaterniond& body_from_left = given.body_from_left.rotation;
  prior_.assume_upright(body_from_left * -Eigen::Vector3d::UnitY(), body_from_left * Eigen::Vector3d::UnitZ());
  if (!options.offline) prior_.enable_mapping_mode();
  if (is_metric_) prior_.set_metric();
  session_.set_odometry([this](Timestamp earlier, Timestamp later) { return prior_.path_between(earlier, later); },
                        [this, is_metric = given.is_metric()](Timestamp earlier, Timestamp later) {
                          return prior_.reach(earlier, later, is_metric);
                        });
  if (options.self_calibrate) refine_calibration(given, options, before.has_value());
  if (before) session_.continue_map(std::move(*before));
}

// Refines only the readout time if the calibration is refined already, or an extended map depends on it.
void Engine::refine_calibration(const Calibration& given, const EngineOptions& options, bool is_extended) {
  if (initial_calibration_ || is_extended) {
    session_.refine_readout(initial_calibration_.value_or(RefinedCalibration{given}));
  } else {
    session_.refine_calibration(given, options.self_calibration);
  }
}

FrameReport Engine::process(const Frame& frame, const std::optional<BodyMotion>& motion) {
  budget_.begin();
  return process_in_time(frame, motion);
}

std::optional<BodyMotion> Engine::checked(const std::optional<BodyMotion>& motion, Timestamp time) {
  if (!motion) return {};
  return prior_.checked(*motion, time, last_frame_ ? to_seconds(time) - to_seconds(*last_frame_) : 0.0);
}

FrameReport Engine::process_in_time(const Frame& frame, const std::optional<BodyMotion>& given) {
  log_.job_seconds.clear();
  const std::optional<BodyMotion> motion = checked(given, frame.time);
  const bool uses_samples = !given && last_frame_ && !prior_.is_empty();
  const auto measured_motion = uses_samples ? prior_.between(*last_frame_, frame.time) : motion;
  session_.set_tilt(uses_samples ? prior_.tilt(frame.time) : std::nullopt);
  FrameReport report = session_.process(frame, measured_motion, &budget_);
  last_frame_ = frame.time;
  const bool is_seen = report.inliers > 0;
  prior_.note(frame.time, is_seen ? report.odometry_from_body : std::nullopt);
  if (is_seen && report.map_from_body && report.health.verdict == Verdict::trusted) {
    prior_.note_place(*report.map_from_body);
  }
  if (map_damage() != nullptr) {
    report.health.verdict = Verdict::untrusted;
    report.health.doubt = DistrustReason::map_damaged;
  }
  budget_.end();
  report.cuts = budget_.cuts();
  report.is_late = budget_.is_late();
  const auto first_new = warnings().begin() + static_cast<std::ptrdiff_t>(warnings_reported_);
  report.warnings.assign(first_new, warnings().end());
  warnings_reported_ = warnings().size();
  return report;
}

Engine::Processed Engine::process(const ImageFrame& images, const std::optional<BodyMotion>& motion) {
  const double submit_seconds_before = log_.submit_seconds;
  const Stopwatch watch;
  budget_.begin();
  const bool is_left_alone = images.right && !budget_.has_time_for_right_image();
  const Extraction extraction = extractor_.extract(images, is_left_alone ? ImagesUsed::left : ImagesUsed::all);
  if (extraction.frame.right_condition) row_error_.note(*extraction.frame.features, extractor_.rig());
  Processed processed{process_in_time(extraction.frame, motion), {}};
  processed.seconds.total = watch.seconds();
  processed.seconds.rectify = extraction.times.rectify;
  processed.seconds.extract = extraction.times.extract;
  processed.seconds.stereo = extraction.times.stereo;
  processed.seconds.track = processed.report.track_seconds;
  processed.seconds.map = processed.report.map_seconds;
  processed.seconds.map_submit = log_.submit_seconds - submit_seconds_before;
  return processed;
}

FinishResult Engine::finish_map(const FinishHooks& hooks) {
  const Stopwatch watch;
  extractor_.rest();
  FinishResult finishing;
  finishing.report = session_.finish_map(hooks);
  prior_.reestimate(session_.final_trajectory());
  if (!is_metric_) scale_by_wheels();
  finishing.cut_short = hooks.should_stop();
  finishing.seconds = watch.seconds();
  return finishing;
}

// Keeps the map's own unit if motions do not determine the scale.
void Engine::scale_by_wheels() {
  constexpr double kMaxSigma = 0.02;     // share
  constexpr double kMaxTurnScale = 0.1;  // natural logarithm
  const auto& wheels = prior_.wheels();
  if (!wheels || wheels->scale_sigma > kMaxSigma) return;
  // A wrong wheel radius scales path lengths and turns by the same factor.
  if (std::abs(std::log(wheels->turn_errors.scale)) > kMaxTurnScale) {
    prior_.warn(
        {MotionSensor::wheels,
         {},
         fmt::format("wheels measure turns {:.3g} times as large as the camera does; the map has no metric scale",
                     1.0 / wheels->turn_errors.scale),
         "calibrate wheel radius and track width, or scale the map with byre scale"});
    return;
  }
  const double factor = wheels->metres_per_unit;
  session_.rescale(factor);
  scale_sigma_ = std::hypot(wheels->scale_sigma, min_scale_sigma_);
  prior_.rescale(factor);
  is_metric_ = true;
}

double Engine::finish_mission(const FinishHooks& hooks) {
  const Stopwatch watch;
  session_.finish_mission(hooks);
  return watch.seconds();
}

std::optional<RefinedCalibration> Engine::calibration() const {
  const auto refined = session_.self_calibration();
  return refined ? refined : initial_calibration_;
}

Map Engine::map_to_save() const {
  const MapView map = session_.map();
  return map.offline() ? offline_copy(standalone_copy(map)) : offline_copy(map.online());
}

Map Engine::take_map_to_save() {
  return session_.map().offline() ? map_to_save() : offline_copy(session_.take_online());
}

}  // namespace byre
