#include "byre/cli/map_run.h"

#include "byre/cli/decode_ahead.h"
#include "byre/cli/live_clock.h"
#include "byre/cli/logged_executor.h"
#include "byre/cli/resources.h"
#include "byre/cli/stopwatch.h"
#include "byre/input/input_error.h"

#include <utility>

namespace byre::cli {
namespace {

// The second lane of a mission looks for places in the offline map.
Lanes make_lanes(Pace pace, bool is_mission, JobLog& log) {
  switch (pace) {
    case Pace::same_thread:
      return {make_logged_executor(make_inline_executor(), log), make_inline_executor()};
    case Pace::paced:
      return {make_logged_executor(make_paced_executor(kPacedLatency), log),
              make_paced_executor(is_mission ? kPacedSearchLatency : kPacedCorrectionLatency)};
    case Pace::live:
      return {make_logged_executor(make_live_executor(), log), make_live_executor()};
  }
  return {nullptr, nullptr};
}

// Extracts, tracks and maps, and notes what each took.
class FrameThread {
 public:
  // known: of the cameras by now. Only the readout time is refined then, as with cameras that a map before lies by.
  FrameThread(const Calibration& given, const std::optional<RefinedCalibration>& known, const MapRunOptions& options,
              std::optional<Map> before)
      : extractor_(known ? known->calibration : given, options.extract),
        session_(extractor_.rig(), options.session, make_lanes(options.pace, options.offline != nullptr, log_),
                 options.vocabulary, options.offline) {
    if (options.self_calibrate) {
      if (known || before) {
        session_.refine_readout(known.value_or(RefinedCalibration{given}));
      } else {
        session_.refine_calibration(given, options.self_calibration);
      }
    }
    if (before) session_.continue_map(std::move(*before));
  }

  MappedFrame process(const DecodedFrame& decoded) {
    MappedFrame frame;
    frame.time = decoded.time;
    if (decoded.images) frame = process(*decoded.images);
    frame.seconds.decode = decoded.seconds;
    frame.keyframes = online().keyframe_count();
    frame.points = online().point_count();
    frame.memory_mb = resident_memory_mb();
    return frame;
  }

  void hurry() { session_.hurry(); }
  void finish() { session_.finish(); }
  Finishing finish_map(const FinishOptions& options, const FinishHooks& hooks) {
    const Stopwatch watch;
    Finishing finishing;
    finishing.report = session_.finish_map(options, hooks);
    finishing.cut_short = hooks.should_stop();
    finishing.seconds = watch.seconds();
    return finishing;
  }

  double finish_mission(const FinishOptions& options, const FinishHooks& hooks) {
    const Stopwatch watch;
    session_.finish_mission(options, hooks);
    return watch.seconds();
  }

  const Map& online() const { return session_.map().online(); }
  const Session& session() const { return session_; }
  const JobLog& log() const { return log_; }

 private:
  MappedFrame process(const ImageFrame& images) {
    const double submit_seconds_before = log_.submit_seconds;
    const Stopwatch watch;
    const Extraction extraction = extractor_.extract(images);
    const FrameReport report = session_.process(extraction.frame);
    const double total = watch.seconds();

    MappedFrame frame;
    frame.time = images.time;
    frame.has_right = images.right.has_value();
    frame.has_depth = images.depth.has_value();
    frame.report = report;
    frame.seconds.rectify = extraction.times.rectify;
    frame.seconds.extract = extraction.times.extract;
    frame.seconds.stereo = extraction.times.stereo;
    frame.seconds.track = report.track_seconds;
    frame.seconds.map = report.map_seconds;
    frame.seconds.map_submit = log_.submit_seconds - submit_seconds_before;
    frame.seconds.total = total;
    return frame;
  }

  JobLog log_;
  Extractor extractor_;
  Session session_;
};

bool has_pose(const MappedFrame& frame) {
  return frame.report && frame.report->map_from_body;
}

void take_over_result(const FrameThread& thread, MapRun& run) {
  run.final = thread.session().final_trajectory();
  run.map = offline_copy(standalone_copy(thread.session().map()));
  if (const auto refined = thread.session().self_calibration()) run.calibration = refined;
  if (run.finishing) run.finishing->faults = find_faults(run.map);
  run.job_seconds = thread.log().job_seconds;
  for (const MappedFrame& frame : run.frames) {
    if (has_pose(frame)) run.causal.push_back({frame.time, *frame.report->map_from_body});
    if (frame.report && frame.report->odometry_from_body) {
      run.odometry.push_back({frame.time, *frame.report->odometry_from_body});
    }
  }
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

MapRun run_map(Recording& recording, const MapRunOptions& options, const MapRunHooks& hooks,
               std::optional<Map> before) {
  const Stopwatch watch;
  const Calibration given = recording.calibration();
  auto known = options.known;
  if (!known && options.offline) known = known_calibration(options.offline->recordings(), given);
  FrameThread thread(given, known, options, std::move(before));
  DecodeAhead decoder(recording);
  LiveClock clock;
  MapRun run;
  bool is_begun = false;
  while (std::optional<DecodedFrame> decoded = decoder.next()) {
    if (options.pace == Pace::live) {
      const double late = clock.wait_until_due(decoded->time, hooks.should_stop);
      if (late > 0.0) run.lateness.push_back(late);
    }
    if (hooks.should_stop()) break;
    run.warnings.insert(run.warnings.end(), decoded->warnings.begin(), decoded->warnings.end());
    run.frames.push_back(thread.process(*decoded));
    hooks.after_frame(static_cast<int>(run.frames.size()), run.frames.back());
    if (hooks.look && decoded->images) hooks.look({*decoded->images, run.frames.back(), thread.session()});
    is_begun = is_begun || has_pose(run.frames.back());
    if (is_begun && hooks.offer_map) hooks.offer_map(thread.online(), thread.session().self_calibration());
  }
  if (hooks.should_stop()) thread.hurry();
  thread.finish();
  const FinishHooks finish_hooks{hooks.should_stop, hooks.before_finishing_step};
  if (is_begun && !hooks.should_stop()) {
    if (options.offline) {
      run.mission_finishing_seconds = thread.finish_mission(options.finish, finish_hooks);
    } else if (options.vocabulary) {
      run.finishing = thread.finish_map(options.finish, finish_hooks);
    }
  }
  run.calibration = known;
  take_over_result(thread, run);
  run.wall_seconds = watch.seconds();
  return run;
}

}  // namespace byre::cli
