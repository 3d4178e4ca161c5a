#include "byre/playback/report/mission_report.h"

#include "byre/base/report_row.h"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kListedDoubts = 3;

double share(int part, int whole) {
  return whole > 0 ? static_cast<double>(part) / whole : 0.0;
}

std::string describe_verdicts(const MissionStatistics& statistics) {
  const auto percent = [&statistics](int frames) { return 100.0 * share(frames, statistics.frames); };
  std::string text = fmt::format("trusted {:.1f} %, degraded {:.1f} %, untrusted {:.1f} %", percent(statistics.trusted),
                                 percent(statistics.degraded), percent(statistics.untrusted));
  if (statistics.missing > 0) text += fmt::format(", missing {:.1f} %", percent(statistics.missing));
  return text + fmt::format(" of {} frames", statistics.frames);
}

std::string describe_missing(const MissionStatistics& statistics) {
  return fmt::format("{} of {} frames could not be read", statistics.missing, statistics.frames) +
         (misses_too_many_frames(statistics) ? ": too many for verdict shares to describe the mission" : "");
}

std::string describe_doubts(const MissionStatistics& statistics) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kListedDoubts, statistics.doubts.size()); ++i) {
    const auto& [doubt, frames] = statistics.doubts[i];
    text += (text.empty() ? "" : ", ") + std::string(to_string(doubt)) + fmt::format(" {}", frames);
  }
  return text + " frames";
}

std::string describe_losses(const MissionStatistics& statistics) {
  return fmt::format("{} times, relocalised {} times; {} navigation errors", statistics.losses,
                     statistics.relocalisations, statistics.navigation_errors);
}

// Maximum dirt over the mission.
std::string describe_dirt(const MissionStatistics& statistics) {
  Health health;
  health.hidden_share = statistics.max_hidden;
  health.hidden_share_right = statistics.max_hidden_right;
  return note_on_dirt(health) + fmt::format(" (maximum; {} frames)", statistics.frames_with_dirt);
}

// Empty if the mission had no such places.
std::string keyframe_row(const char* places, const KeyframeRate& rate) {
  if (rate.minutes <= 0.0) return "";
  return row("keyframes", fmt::format("{:.1f} per minute in {} places ({} in {:.0f} s)", rate.per_minute(), places,
                                      rate.keyframes, 60.0 * rate.minutes));
}

std::string describe_inliers(const MissionStatistics& statistics) {
  std::string text = fmt::format("offline median {:.0f}, online {:.0f}", statistics.offline_inliers.median,
                                 statistics.online_inliers.median);
  if (statistics.max_suspended > 0)
    text += fmt::format("; up to {} offline points suspended", statistics.max_suspended);
  return text;
}

std::string describe_alignment(const MissionErrors& errors) {
  if (!errors.in_map_frame) return "causal and final poses are aligned to it separately";
  if (errors.alignment_poses == 0) return "in the map's frame, without alignment";
  return fmt::format("aligned to the map by {} poses of the run that made the map", errors.alignment_poses);
}

std::string error_row(const char* name, const std::vector<PoseError>& errors) {
  const ErrorStatistics position = position_statistics(errors);
  if (position.count == 0) return row(name, "no pose with truth");
  return row(name,
             fmt::format("RMSE {:.4f} m and {:.3f} deg, median {:.4f} m, 95 % within {:.4f} m, max {:.4f} m",
                         position.rmse, rotation_statistics(errors).rmse, position.median, position.p95, position.max));
}

std::string trust_rows(const MissionErrors& errors) {
  std::string text = error_row("trusted", errors.trusted);
  text += row("wrong trust", fmt::format("{} trusted frames with an error above {:g} m, longest {:.2f} s",
                                         errors.wrongly_trusted, kFarMetres, errors.longest_wrong_trust_s));
  if (!errors.within_bound) return text;
  std::string within = fmt::format("{:.1f} % of causal positions within its 95 % bound", 100.0 * *errors.within_bound);
  if (errors.within_bound_without_map_error) {
    within += fmt::format(", {:.1f} % without the map's own error", 100.0 * *errors.within_bound_without_map_error);
  }
  text += row("covariance", within);
  return text;
}

Json to_json(const KeyframeRate& rate) {
  return {{"keyframes", rate.keyframes}, {"minutes", rate.minutes}, {"keyframes_per_minute", rate.per_minute()}};
}

Json to_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

Json doubts_json(const MissionStatistics& statistics) {
  Json doubts = Json::object();
  for (const auto& [doubt, frames] : statistics.doubts) doubts[std::string(to_string(doubt))] = frames;
  return doubts;
}

Json errors_json(const std::vector<PoseError>& errors) {
  const auto statistics = [](const ErrorStatistics& of) {
    return Json{{"rmse", of.rmse}, {"median", of.median}, {"p95", of.p95}, {"max", of.max}};
  };
  return {{"count", errors.size()},
          {"position_m", statistics(position_statistics(errors))},
          {"rotation_deg", statistics(rotation_statistics(errors))}};
}

}  // namespace

std::string to_text(const MissionStatistics& statistics) {
  std::string text = row("verdicts", describe_verdicts(statistics));
  if (statistics.missing > 0) text += row("missing", describe_missing(statistics));
  if (!statistics.doubts.empty()) text += row("doubts", describe_doubts(statistics));
  text += row("lost", describe_losses(statistics));
  text += keyframe_row("known", statistics.in_mapped_area);
  text += keyframe_row("changed or new", statistics.in_changed_or_new);
  text += row("inliers", describe_inliers(statistics));
  if (statistics.frames_with_dirt > 0) text += row("dirt", describe_dirt(statistics));
  return text;
}

std::string to_text(const MissionErrors& errors) {
  std::string text = row("truth", describe_alignment(errors));
  if (!errors.map.empty()) text += error_row("map", errors.map);
  text += error_row("causal", errors.causal);
  text += error_row("final", errors.final);
  if (errors.in_map_frame) text += trust_rows(errors);
  return text;
}

Json to_json(const MissionStatistics& statistics) {
  const std::optional<double>& first = statistics.seconds_to_first_pose;
  return {{"frames_missing", statistics.missing},
          {"is_full_of_gaps", misses_too_many_frames(statistics)},
          {"frames_trusted", statistics.trusted},
          {"frames_degraded", statistics.degraded},
          {"frames_untrusted", statistics.untrusted},
          {"trusted_share", share(statistics.trusted, statistics.frames)},
          {"doubts", doubts_json(statistics)},
          {"seconds_to_first_pose", first ? Json(*first) : Json()},
          {"losses", statistics.losses},
          {"relocalisations", statistics.relocalisations},
          {"navigation_errors", statistics.navigation_errors},
          {"in_known_places", to_json(statistics.in_mapped_area)},
          {"in_changed_or_new_places", to_json(statistics.in_changed_or_new)},
          {"offline_inliers_median", statistics.offline_inliers.median},
          {"online_inliers_median", statistics.online_inliers.median},
          {"most_suspended", statistics.max_suspended},
          {"frames_with_dirt", statistics.frames_with_dirt},
          {"most_hidden", statistics.max_hidden},
          {"most_hidden_right", statistics.max_hidden_right}};
}

Json to_json(const MissionErrors& errors) {
  return {{"of", errors.in_map_frame ? "poses in the map's frame" : "poses after alignment"},
          {"alignment_poses", errors.alignment_poses},
          {"causal", errors_json(errors.causal)},
          {"causal_trusted", errors_json(errors.trusted)},
          {"causal_degraded", errors_json(errors.degraded)},
          {"final", errors_json(errors.final)},
          {"trusted_off_by_more_than_0.2m", errors.wrongly_trusted},
          {"longest_wrong_trust_s", errors.longest_wrong_trust_s},
          {"share_within_95_percent_bound", to_json(errors.within_bound)},
          {"map", errors_json(errors.map)},
          {"share_within_95_percent_bound_beside_map", to_json(errors.within_bound_without_map_error)}};
}

}  // namespace byre
