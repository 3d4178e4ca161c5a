#include "byre/playback/report/map_statistics.h"

#include <utility>

namespace byre {
namespace {

template <typename SecondsOf>
Distribution summarise_processed(const std::vector<PlayedFrame>& frames, SecondsOf seconds_of) {
  std::vector<double> seconds;
  for (const PlayedFrame& frame : frames) {
    if (frame.report) seconds.push_back(seconds_of(frame.seconds));
  }
  return summarise_times(std::move(seconds));
}

void count_events(const FrameReport& report, FrameCounts& counts) {
  counts.relocalisations += report.has(SessionEvent::relocalised) ? 1 : 0;
  counts.loops += report.has(SessionEvent::loop_found) ? 1 : 0;
  counts.resets += report.has(SessionEvent::restarted) ? 1 : 0;
  counts.corrections += report.has(SessionEvent::map_corrected) ? 1 : 0;
}

}  // namespace

Distribution summarise_times(std::vector<double> seconds) {
  for (double& each : seconds) each *= 1e3;
  return distribution_of(std::move(seconds));
}

Distribution summarise_stage(const std::vector<PlayedFrame>& frames, double StageSeconds::*stage) {
  return summarise_processed(frames, [stage](const StageSeconds& seconds) { return seconds.*stage; });
}

Distribution summarise_without_jobs(const std::vector<PlayedFrame>& frames) {
  return summarise_processed(frames, [](const StageSeconds& seconds) { return seconds.total - seconds.map_submit; });
}

FrameCounts count_frames(const std::vector<PlayedFrame>& frames) {
  FrameCounts counts;
  State state = State::initialising;
  for (const PlayedFrame& frame : frames) {
    if (frame.report && frame.report->map_from_body && counts.with_pose == 0) counts.frames_to_first = counts.frames;
    ++counts.frames;
    counts.unreadable += frame.report ? 0 : 1;
    if (!frame.report) continue;
    counts.without_right_image += frame.has_right ? 0 : 1;
    counts.with_depth_image += frame.has_depth ? 1 : 0;
    counts.without_online_points += frame.report->cuts.online_points ? 1 : 0;
    counts.with_left_alone += frame.report->cuts.right_image ? 1 : 0;
    counts.late += frame.report->is_late ? 1 : 0;
    count_events(*frame.report, counts);
    if (frame.report->start_failure != TwoViewFailure::none) ++counts.refused_starts[frame.report->start_failure];
    const State before = std::exchange(state, frame.report->state);
    counts.with_pose += frame.report->map_from_body ? 1 : 0;
    counts.keyframes += frame.report->keyframe_added ? 1 : 0;
    counts.lost += needs_relocalisation(state) ? 1 : 0;
    counts.lost_episodes += needs_relocalisation(state) && !needs_relocalisation(before) ? 1 : 0;
  }
  return counts;
}

}  // namespace byre
