#include "byre/playback/report/mission_statistics.h"

#include <algorithm>
#include <map>

namespace byre {
namespace {

constexpr double kSecondsPerMinute = 60.0;
constexpr double kMaxMissing = 0.05;

void count_verdict(const Health& health, MissionStatistics& statistics) {
  switch (health.verdict) {
    case Verdict::trusted:
      ++statistics.trusted;
      return;
    case Verdict::degraded:
      ++statistics.degraded;
      return;
    case Verdict::untrusted:
      ++statistics.untrusted;
      return;
  }
}

void count_events(const FrameReport& report, MissionStatistics& statistics) {
  statistics.losses += report.has(SessionEvent::pose_lost) ? 1 : 0;
  statistics.relocalisations += report.has(SessionEvent::relocalised) ? 1 : 0;
  statistics.navigation_errors += report.has(SessionEvent::navigation_error) ? 1 : 0;
}

void note_dirt(const Health& health, MissionStatistics& statistics) {
  statistics.max_hidden = std::max(statistics.max_hidden, health.hidden_share);
  statistics.max_hidden_right = std::max(statistics.max_hidden_right, health.hidden_share_right);
  if (health.hidden_share > 0.0 || health.hidden_share_right > 0.0) ++statistics.frames_with_dirt;
}

std::vector<std::pair<DistrustReason, int>> count_doubts(const std::vector<PlayedFrame>& frames) {
  std::map<DistrustReason, int> counts;
  for (const PlayedFrame& frame : frames) {
    if (frame.report && frame.report->health.verdict != Verdict::trusted) ++counts[frame.report->health.doubt];
  }
  std::vector<std::pair<DistrustReason, int>> doubts(counts.begin(), counts.end());
  std::ranges::stable_sort(doubts, [](const auto& a, const auto& b) { return a.second > b.second; });
  return doubts;
}

ErrorStatistics inliers_with_pose(const std::vector<PlayedFrame>& frames, int Health::*inliers) {
  std::vector<double> counts;
  for (const PlayedFrame& frame : frames) {
    if (frame.report && frame.report->map_from_body) counts.push_back(frame.report->health.*inliers);
  }
  return summarise(std::move(counts));
}

// A frame accounts for the time since the previous one.
void add_to_rate(const FrameReport& report, double seconds, KeyframeRate& rate) {
  rate.keyframes += report.keyframe_added ? 1 : 0;
  rate.minutes += seconds / kSecondsPerMinute;
}

}  // namespace

bool misses_too_many_frames(int missing, int frames) {
  return missing > kMaxMissing * frames;
}

MissionStatistics summarise_mission(const std::vector<PlayedFrame>& frames, int min_offline_inliers) {
  MissionStatistics statistics;
  std::optional<Timestamp> last_time;
  for (const PlayedFrame& frame : frames) {
    const double seconds = last_time ? to_seconds(frame.time - *last_time) : 0.0;
    last_time = frame.time;
    ++statistics.frames;
    statistics.missing += frame.report ? 0 : 1;
    if (!frame.report) continue;
    const FrameReport& report = *frame.report;
    count_verdict(report.health, statistics);
    count_events(report, statistics);
    statistics.max_suspended = std::max(statistics.max_suspended, report.health.suspended);
    note_dirt(report.health, statistics);
    if (!report.map_from_body) continue;
    if (!statistics.seconds_to_first_pose) {
      statistics.seconds_to_first_pose = to_seconds(frame.time - frames.front().time);
    }
    const bool is_in_mapped_area = report.health.offline_inliers >= min_offline_inliers;
    add_to_rate(report, seconds, is_in_mapped_area ? statistics.in_mapped_area : statistics.in_changed_or_new);
  }
  statistics.doubts = count_doubts(frames);
  statistics.offline_inliers = inliers_with_pose(frames, &Health::offline_inliers);
  statistics.online_inliers = inliers_with_pose(frames, &Health::online_inliers);
  return statistics;
}

}  // namespace byre
