#include "byre/playback/report/mission_report.h"

#include <utility>

namespace byre {
namespace {

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

}  // namespace

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

}  // namespace byre
