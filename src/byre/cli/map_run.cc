#include "byre/cli/map_run.h"

#include "byre/cli/decode_ahead.h"
#include "byre/cli/live_clock.h"
#include "byre/cli/logged_executor.h"
#include "byre/cli/stopwatch.h"

#include <memory>
#include <utility>

namespace byre::cli {
namespace {

std::unique_ptr<Executor> make_executor(Pace pace) {
  switch (pace) {
    case Pace::same_thread:
      return make_inline_executor();
    case Pace::paced:
      return make_paced_executor(kPacedLatency);
    case Pace::live:
      return make_live_executor();
  }
  return nullptr;
}

// Extracts, tracks and maps, and notes what each took.
class FrameThread {
 public:
  FrameThread(const Calibration& calibration, const MapRunOptions& options)
      : extractor_(calibration, options.extract),
        session_(extractor_.rig(), options.session, make_logged_executor(make_executor(options.pace), log_)) {}

  MappedFrame process(const DecodedFrame& decoded) {
    MappedFrame frame;
    frame.time = decoded.time;
    if (decoded.images) frame = process(*decoded.images);
    frame.seconds.decode = decoded.seconds;
    return frame;
  }

  void finish() { session_.finish(); }

  const Session& session() const { return session_; }
  const JobLog& log() const { return log_; }

 private:
  MappedFrame process(const ImageFrame& images) {
    const double submit_seconds_before = log_.submit_seconds;
    const Stopwatch watch;
    const Extraction extraction = extractor_.extract(images);
    const FrameReport report = session_.process(extraction.frame);
    const double total = watch.seconds();

    MappedFrame frame{images.time, images.right.has_value(), report, {}};
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

void take_over_result(const FrameThread& thread, MapRun& run) {
  run.final = thread.session().final_trajectory();
  run.map = offline_copy(thread.session().map().online());
  run.job_seconds = thread.log().job_seconds;
  for (const MappedFrame& frame : run.frames) {
    if (frame.report && frame.report->world_from_body)
      run.causal.push_back({frame.time, *frame.report->world_from_body});
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

MapRun run_map(Recording& recording, const MapRunOptions& options, const MapRunHooks& hooks) {
  const Stopwatch watch;
  FrameThread thread(recording.calibration(), options);
  DecodeAhead decoder(recording);
  LiveClock clock;
  MapRun run;
  while (std::optional<DecodedFrame> decoded = decoder.next()) {
    if (options.pace == Pace::live) {
      const double late = clock.wait_until_due(decoded->time, hooks.should_stop);
      if (late > 0.0) run.lateness.push_back(late);
    }
    if (hooks.should_stop()) break;
    run.warnings.insert(run.warnings.end(), decoded->warnings.begin(), decoded->warnings.end());
    run.frames.push_back(thread.process(*decoded));
    hooks.after_frame(static_cast<int>(run.frames.size()), run.frames.back());
  }
  thread.finish();
  take_over_result(thread, run);
  run.wall_seconds = watch.seconds();
  return run;
}

}  // namespace byre::cli
