#include "byre/benchmark/chart.h"
#include "byre/benchmark/life.h"
#include "byre/benchmark/markdown_table.h"
#include "byre/playback/report/report_json.h"

#include <functional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

Json version_json(const VersionLocalisation& version) {
  return {{"in_view", version.in_view}, {"found", version.found}, {"falsely", version.falsely}};
}

Json mission_json(const LifeMission& mission) {
  return {{"trusted", mission.trusted},
          {"within_5_cm", mission.within_5_cm},
          {"wrongly_trusted", mission.wrongly_trusted},
          {"median_error_m", mission.median_error},
          {"greatest_error_m", mission.greatest_error},
          {"offline_inliers", mission.offline_inliers}};
}

std::string percent(double share) {
  return fmt::format("{:.1f}", 1e2 * share);
}

std::string both(const LifeDay& day, const std::function<std::string(const LifeMission&)>& text) {
  return text(day.first) + ", " + text(day.newest);
}

std::string text_of(const std::optional<MapUpdateResult>& update) {
  if (!update) return "nothing new";
  if (!update->refusal.empty()) return "refused: " + update->refusal;
  return fmt::format("+{} keyframes, +{} points, -{}", update->keyframes_added, update->points_added,
                     update->points_retired);
}

LifeMission mean_of(const LifeResult& result, LifeMission LifeDay::*mission) {
  LifeMission mean;
  const auto days = static_cast<double>(result.days.size());
  for (const LifeDay& day : result.days) {
    const LifeMission& one = day.*mission;
    mean.trusted += one.trusted / days;
    mean.within_5_cm += one.within_5_cm / days;
    mean.wrongly_trusted += one.wrongly_trusted;
    mean.median_error += one.median_error / days;
    mean.greatest_error = std::max(mean.greatest_error, one.greatest_error);
    mean.offline_inliers += one.offline_inliers / days;
  }
  return mean;
}

Chart chart_of(const LifeResult& result, const char* title, const char* unit,
               const std::function<double(const LifeMission&)>& value) {
  Chart chart{.title = title, .subtitle = "", .x_label = "day", .y_label = unit};
  ChartSeries first{.name = "first version", .colour = "#b8b8b4", .pieces = {{}}};
  ChartSeries newest{.name = "updated", .colour = "#0072b2", .pieces = {{}}};
  for (std::size_t i = 0; i < result.days.size(); ++i) {
    const auto day = static_cast<double>(i + 2);
    first.pieces[0].emplace_back(day, value(result.days[i].first));
    newest.pieces[0].emplace_back(day, value(result.days[i].newest));
  }
  chart.series = {first, newest};
  return chart;
}

Chart chart_of_upkeep(const LifeResult& result, const char* title, const char* unit,
                      const std::function<double(const LifeDay&)>& value) {
  Chart chart{.title = title, .subtitle = "", .x_label = "day", .y_label = unit};
  ChartSeries series{.name = "updated", .colour = "#0072b2", .pieces = {{}}};
  for (std::size_t i = 0; i < result.days.size(); ++i) {
    series.pieces[0].emplace_back(static_cast<double>(i + 2), value(result.days[i]));
  }
  chart.series = {series};
  return chart;
}

}  // namespace

std::string life_markdown(const LifeResult& result) {
  MarkdownTable table({"day", "trusted, %", "within 5 cm, %", "wrong", "median, mm", "greatest, mm", "offline inliers",
                       "update", "update, s", "session, MB", "map, MB"});
  const auto add = [&](const LifeDay& day, std::vector<std::string> upkeep) {
    std::vector<std::string> cells = {
        day.name,
        both(day, [](const LifeMission& mission) { return percent(mission.trusted); }),
        both(day, [](const LifeMission& mission) { return percent(mission.within_5_cm); }),
        both(day, [](const LifeMission& mission) { return fmt::format("{}", mission.wrongly_trusted); }),
        both(day, [](const LifeMission& mission) { return fmt::format("{:.1f}", 1e3 * mission.median_error); }),
        both(day, [](const LifeMission& mission) { return fmt::format("{:.0f}", 1e3 * mission.greatest_error); }),
        both(day, [](const LifeMission& mission) { return fmt::format("{:.0f}", mission.offline_inliers); })};
    cells.insert(cells.end(), upkeep.begin(), upkeep.end());
    table.add(std::move(cells));
  };
  for (const LifeDay& day : result.days) {
    add(day, {text_of(day.update), fmt::format("{:.1f}", day.update_seconds), fmt::format("{:.1f}", day.session_mb),
              fmt::format("{:.2f}", day.map_mb)});
  }
  if (!result.days.empty()) {
    LifeDay mean;
    mean.name = "mean";
    mean.first = mean_of(result, &LifeDay::first);
    mean.newest = mean_of(result, &LifeDay::newest);
    add(mean, {"", "", "", fmt::format("{:.2f} at first", result.first_map_mb)});
  }
  std::string text = "Missions on the first version of the map, and on its updates.\n\n" + table.text();
  if (result.localisation) {
    const LifeLocalisation& found = *result.localisation;
    text += fmt::format(
        "\nLocalised without a prediction, {} frames of the last days: {} of {} and {} of {} found where 60 points are "
        "in "
        "view, {} and {} of all frames falsely.\n"
        "Places, {}: median poses of the first and the newest version differ by at most {:.1f} mm and {:.3f} "
        "degrees.\n",
        found.frames, found.first.found, found.first.in_view, found.newest.found, found.newest.in_view,
        found.first.falsely, found.newest.falsely, found.places, 1e3 * found.shift, found.turn);
  }
  return text;
}

std::string life_json(const LifeResult& result) {
  Json days = Json::array();
  for (const LifeDay& day : result.days) {
    days.push_back({{"name", day.name},
                    {"first", mission_json(day.first)},
                    {"newest", mission_json(day.newest)},
                    {"update", text_of(day.update)},
                    {"update_s", day.update_seconds},
                    {"update_memory_mb", day.update_memory_mb},
                    {"session_mb", day.session_mb},
                    {"map_mb", day.map_mb}});
  }
  Json json = {{"first_map_mb", result.first_map_mb}, {"days", days}, {"stopped", result.stopped}};
  if (result.localisation) {
    const LifeLocalisation& found = *result.localisation;
    json["localisation"] = {{"frames", found.frames},
                            {"first", version_json(found.first)},
                            {"newest", version_json(found.newest)},
                            {"places", found.places},
                            {"shift_m", found.shift},
                            {"turn_deg", found.turn}};
  }
  return dump_json(json, 2) + "\n";
}

std::string life_plot(const LifeResult& result) {
  return to_svg(
      {chart_of(result, "Trusted", "% of the frames", [](const auto& one) { return 1e2 * one.trusted; }),
       chart_of(result, "Within 5 cm", "% of the frames", [](const auto& one) { return 1e2 * one.within_5_cm; }),
       chart_of(result, "Median error", "mm", [](const auto& one) { return 1e3 * one.median_error; }),
       chart_of(result, "Greatest error", "mm", [](const auto& one) { return 1e3 * one.greatest_error; }),
       chart_of(result, "Offline inliers", "median", [](const auto& one) { return one.offline_inliers; }),
       chart_of_upkeep(result, "Map", "MB", [](const LifeDay& day) { return day.map_mb; }),
       chart_of_upkeep(result, "Update", "s", [](const LifeDay& day) { return day.update_seconds; })});
}

}  // namespace byre
