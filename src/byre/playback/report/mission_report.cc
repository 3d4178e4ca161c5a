#include "byre/playback/report/mission_report.h"

#include "byre/map/keyframe_path.h"

#include <algorithm>
#include <map>

#include <Eigen/Cholesky>

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

std::vector<PoseError> errors_with(Verdict verdict, const RunResult& run, const std::vector<PoseError>& causal) {
  std::vector<PoseError> chosen;
  for (const PlayedFrame& frame : run.frames) {
    const PoseError* const error = find_error(causal, frame.time);
    if (error != nullptr && frame.report->health.verdict == verdict) chosen.push_back(*error);
  }
  return chosen;
}

bool is_far(const PoseError& error) {
  return error.position() > kFarMetres;
}

// Duration from the first to the last frame of an episode; 0 for a single frame.
double longest_wrong_trust(const RunResult& run, const std::vector<PoseError>& trusted) {
  double longest_s = 0.0;
  const PlayedFrame* first = nullptr;
  for (const PlayedFrame& frame : run.frames) {
    const PoseError* const error = find_error(trusted, frame.time);
    if (error == nullptr || !is_far(*error)) {
      first = nullptr;
      continue;
    }
    if (first == nullptr) first = &frame;
    longest_s = std::max(longest_s, to_seconds(frame.time - first->time));
  }
  return longest_s;
}

// Compares position errors with covariances: both refer to a small motion in the body frame.
std::optional<double> share_within_bound(const RunResult& run, const std::vector<PoseError>& causal) {
  constexpr double kBound95 = 7.815;  // 95 % quantile of chi-square with three degrees of freedom
  int within = 0;
  int judged = 0;
  for (const PlayedFrame& frame : run.frames) {
    const PoseError* const error = find_error(causal, frame.time);
    if (error == nullptr) continue;
    const Eigen::Matrix3d covariance = frame.report->covariance.topLeftCorner<3, 3>();
    if (covariance.trace() <= 0.0) continue;  // first pose of a map: exact by definition
    const Eigen::Vector3d position = error->delta.head<3>();
    ++judged;
    within += position.dot(covariance.ldlt().solve(position)) <= kBound95 ? 1 : 0;
  }
  if (judged == 0) return std::nullopt;
  return static_cast<double>(within) / judged;
}

// Errors by verdict, from the causal errors.
void judge_trust(const RunResult& run, MissionErrors& errors) {
  errors.trusted = errors_with(Verdict::trusted, run, errors.causal);
  errors.degraded = errors_with(Verdict::degraded, run, errors.causal);
  errors.wrongly_trusted = static_cast<int>(std::ranges::count_if(errors.trusted, is_far));
  errors.longest_wrong_trust_s = longest_wrong_trust(run, errors.trusted);
}

std::vector<PoseError> errors_when_aligned(const Trajectory& estimate, const Trajectory& truth, Scale scale) {
  const auto error = absolute_trajectory_error(associate(estimate, truth, {}), scale);
  if (!error) return {};
  return errors_in_map(estimate, truth, {error->truth_from_estimate, 0});
}

using Json = nlohmann::ordered_json;

constexpr std::size_t kListedDoubts = 3;

double share(int part, int whole) {
  return whole > 0 ? static_cast<double>(part) / whole : 0.0;
}

Json rate_json(const KeyframeRate& rate) {
  return {{"keyframes", rate.keyframes}, {"minutes", rate.minutes}, {"keyframes_per_minute", rate.per_minute()}};
}

Json doubts_json(const MissionStatistics& statistics, std::size_t listed) {
  Json doubts = Json::object();
  for (const auto& [doubt, frames] : statistics.doubts) {
    if (doubts.size() < listed) doubts[std::string(to_string(doubt))] = frames;
  }
  return doubts;
}

// Maximum dirt over the mission.
std::string describe_dirt(const MissionStatistics& statistics) {
  Health health;
  health.hidden_share = statistics.max_hidden;
  health.hidden_share_right = statistics.max_hidden_right;
  return note_on_dirt(health);
}

Json pose_errors_json(const std::vector<PoseError>& errors) {
  const auto statistics = [](const ErrorStatistics& of) {
    return Json{{"rmse", of.rmse}, {"median", of.median}, {"p95", of.p95}, {"max", of.max}};
  };
  return {{"count", errors.size()},
          {"position_m", statistics(position_statistics(errors))},
          {"rotation_deg", statistics(rotation_statistics(errors))}};
}

void add_errors(const char* label, const Json& errors, Report& report) {
  report.row(label,
             "[{?count}RMSE {position_m.rmse:.4f} m and {rotation_deg.rmse:.3f} deg, median {position_m.median:.4f} m, "
             "95 % within {position_m.p95:.4f} m, max {position_m.max:.4f} m|no pose with truth]",
             errors);
}

// Trajectory of the mapping run, converted to the body of the mission's calibration.
Trajectory path_of(const OfflineMap& offline, const std::optional<Trajectory>& map_run, const Calibration& given) {
  Trajectory path = map_run ? *map_run : keyframe_path(offline.map());
  const Pose map_body_from_body = stored_body_from_body(offline.recordings(), given).value_or(Pose{});
  for (StampedPose& pose : path) pose.world_from_body = pose.world_from_body * map_body_from_body;
  return path;
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

MissionErrors mission_errors(const RunResult& run, const MapAlignment& alignment, const Trajectory& truth) {
  MissionErrors errors;
  errors.in_map_frame = true;
  errors.alignment_poses = alignment.poses;
  errors.causal = errors_in_map(run.causal, truth, alignment);
  errors.final = errors_in_map(run.final, truth, alignment);
  judge_trust(run, errors);
  errors.within_bound = share_within_bound(run, errors.causal);
  errors.map = errors_of_map(alignment);
  errors.within_bound_without_map_error = share_within_bound(run, errors_relative_to_map(run.causal, truth, alignment));
  return errors;
}

MissionErrors aligned_errors(const RunResult& run, const Trajectory& truth, Scale scale) {
  MissionErrors errors;
  errors.causal = errors_when_aligned(run.causal, truth, scale);
  errors.final = errors_when_aligned(run.final, truth, scale);
  judge_trust(run, errors);
  return errors;
}

Report mission_report(const MissionStatistics& statistics) {
  const int frames = statistics.frames;
  Report report{{{"frames_missing", statistics.missing},
                 {"is_full_of_gaps", misses_too_many_frames(statistics)},
                 {"frames_trusted", statistics.trusted},
                 {"frames_degraded", statistics.degraded},
                 {"frames_untrusted", statistics.untrusted},
                 {"trusted_share", share(statistics.trusted, frames)},
                 {"doubts", doubts_json(statistics, statistics.doubts.size())},
                 {"seconds_to_first_pose", or_null(statistics.seconds_to_first_pose)},
                 {"losses", statistics.losses},
                 {"relocalisations", statistics.relocalisations},
                 {"navigation_errors", statistics.navigation_errors},
                 {"in_known_places", rate_json(statistics.in_mapped_area)},
                 {"in_changed_or_new_places", rate_json(statistics.in_changed_or_new)},
                 {"offline_inliers_median", statistics.offline_inliers.median},
                 {"online_inliers_median", statistics.online_inliers.median},
                 {"most_suspended", statistics.max_suspended},
                 {"frames_with_dirt", statistics.frames_with_dirt},
                 {"most_hidden", statistics.max_hidden},
                 {"most_hidden_right", statistics.max_hidden_right}}};
  report.row("verdicts",
             "trusted {trusted_share*100:.1f} %, degraded {degraded_share*100:.1f} %, "
             "untrusted {untrusted_share*100:.1f} %[{?frames_missing}, missing {missing_share*100:.1f} %] of {frames} "
             "frames",
             {{"degraded_share", share(statistics.degraded, frames)},
              {"untrusted_share", share(statistics.untrusted, frames)},
              {"missing_share", share(statistics.missing, frames)},
              {"frames", frames}});
  report.row("missing",
             "{?frames_missing}{frames_missing} of {frames} frames could not be read"
             "[{?is_full_of_gaps}: too many for verdict shares to describe the mission]",
             {{"frames", frames}});
  report.row("doubts", "{?main_doubts}{main_doubts} frames", {{"main_doubts", doubts_json(statistics, kListedDoubts)}});
  report.row("lost", "{losses} times, relocalised {relocalisations} times; {navigation_errors} navigation errors");
  for (const auto& [places, key] :
       {std::pair("known", "in_known_places"), std::pair("changed or new", "in_changed_or_new_places")}) {
    Json rate = report.figures[key];
    rate["places"] = places;
    report.detail("keyframes",
                  "{?minutes}{keyframes_per_minute:.1f} per minute in {places} places "
                  "({keyframes} in {minutes*60:.0f} s)",
                  rate);
  }
  report.detail("inliers",
                "offline median {offline_inliers_median:.0f}, online {online_inliers_median:.0f}"
                "[{?most_suspended}; up to {most_suspended} offline points suspended]");
  report.row("dirt", "{?frames_with_dirt}{dirt} (maximum; {frames_with_dirt} frames)",
             {{"dirt", describe_dirt(statistics)}});
  return report;
}

Report mission_error_report(const MissionErrors& errors) {
  Report report{{{"of", errors.in_map_frame ? "poses in the map's frame" : "poses after alignment"},
                 {"alignment_poses", errors.alignment_poses},
                 {"causal", pose_errors_json(errors.causal)},
                 {"causal_trusted", pose_errors_json(errors.trusted)},
                 {"causal_degraded", pose_errors_json(errors.degraded)},
                 {"final", pose_errors_json(errors.final)},
                 {"trusted_off_by_more_than_0.2m", errors.wrongly_trusted},
                 {"longest_wrong_trust_s", errors.longest_wrong_trust_s},
                 {"share_within_95_percent_bound", or_null(errors.within_bound)},
                 {"map", pose_errors_json(errors.map)},
                 {"share_within_95_percent_bound_beside_map", or_null(errors.within_bound_without_map_error)}}};
  report.row("truth",
             "[{!in_map_frame}causal and final poses are aligned to it separately"
             "|{!alignment_poses}in the map's frame, without alignment"
             "|aligned to the map by {alignment_poses} poses of the run that made the map]",
             {{"in_map_frame", errors.in_map_frame}});
  if (!errors.map.empty()) add_errors("map", report.figures["map"], report);
  add_errors("causal", report.figures["causal"], report);
  add_errors("final", report.figures["final"], report);
  if (!errors.in_map_frame) return report;
  add_errors("trusted", report.figures["causal_trusted"], report);
  report.row("wrong trust",
             "{trusted_off_by_more_than_0.2m} trusted frames with an error above {far_m:g} m, "
             "longest {longest_wrong_trust_s:.2f} s",
             {{"far_m", kFarMetres}});
  report.row("covariance",
             "{share_within_95_percent_bound*100:.1f} % of causal positions within its 95 % bound"
             "[, {share_within_95_percent_bound_beside_map*100:.1f} % without the map's own error]");
  return report;
}

MissionOutcome evaluate_mission(const RunResult& run, const MethodOptions& options,
                                const std::optional<MissionTruth>& truth, const ScaledRecording& recording) {
  MissionOutcome mission;
  mission.statistics = summarise_mission(run.frames, options.session.mission.view.min_inliers);
  if (!truth) return mission;
  if (!run.offline) {
    mission.errors =
        aligned_errors(run, recording.path_of(truth->frames), recording.is_metric ? Scale::fixed : Scale::free);
    return mission;
  }
  const Trajectory path = path_of(*run.offline, truth->map_run, recording.recording->calibration());
  mission.errors = mission_errors(run, align_to_truth(path, truth->map_scale, truth->map), truth->frames);
  return mission;
}

}  // namespace byre
