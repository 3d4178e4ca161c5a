#include "byre/camera/record_run.h"

#include "byre/base/stopwatch.h"

namespace byre {
namespace {

bool is_after_end(Timestamp time, const RecordedFrames& recorded, const RecordLimits& limits) {
  if (limits.frames && recorded.frames >= *limits.frames) return true;
  return limits.duration_s && recorded.first && to_seconds(time - *recorded.first) > *limits.duration_s;
}

void report_notes(CaptureThread& capture, int skipped_before, const RecordHooks& hooks) {
  for (const std::string& note : capture.take_notes()) hooks.on_note(note);
  if (skipped_before > 0 || capture.skipped() == 0) return;
  hooks.on_note(
      "frames arrive faster than they can be written, some are dropped: use another disk, or set a lower --rate");
}

}  // namespace

RecordedFrames record_frames(CaptureThread& capture, FrameSink& sink, const RecordLimits& limits,
                             const RecordHooks& hooks) {
  constexpr auto kStopInterval = std::chrono::milliseconds(50);
  constexpr double kPatience_s = 10.0;  // longest wait for the first frame
  RecordedFrames recorded;
  const Stopwatch since_start;
  std::optional<Stopwatch> since_first;
  bool is_over = false;
  const auto write_next = [&](std::chrono::milliseconds at_most) {
    const auto frame = capture.next(at_most);
    if (!frame) return false;
    is_over = is_over || is_after_end(frame->time, recorded, limits);
    if (is_over) return false;
    sink.write(*frame);
    if (!recorded.first) recorded.first = frame->time;
    if (!since_first) since_first.emplace();
    recorded.last = frame->time;
    ++recorded.frames;
    if (frame->right) ++recorded.with_right;
    hooks.after_frame(recorded.frames, *frame);
    is_over = limits.frames && recorded.frames >= *limits.frames;
    return true;
  };
  const auto is_late = [&](double seconds) { return limits.duration_s && seconds > *limits.duration_s; };
  while (!is_over && !hooks.should_stop()) {
    write_next(kStopInterval);
    report_notes(capture, recorded.skipped, hooks);
    recorded.skipped = capture.skipped();
    is_over = is_over || is_late(since_first ? since_first->seconds() : since_start.seconds() - kPatience_s);
  }
  capture.stop();
  is_over = false;  // writes the queued frames within the limits
  while (write_next({})) {
  }
  sink.finish();
  recorded.cameras = capture.report();
  return recorded;
}

}  // namespace byre
