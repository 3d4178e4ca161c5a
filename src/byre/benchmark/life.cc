#include "byre/benchmark/life.h"

#include "byre/base/stopwatch.h"
#include "byre/benchmark/markdown_table.h"
#include "byre/benchmark/measures.h"
#include "byre/benchmark/plots.h"
#include "byre/benchmark/speed.h"
#include "byre/features/extract.h"
#include "byre/geometry/degrees.h"
#include "byre/geometry/evaluation/map_frame_error.h"
#include "byre/geometry/median.h"
#include "byre/input_error.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/playback/localise_run.h"
#include "byre/playback/report/mission_report.h"
#include "byre/playback/report/report.h"
#include "byre/slam/places/place_view.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr double kBytesPerMegabyte = 1e6;
constexpr std::size_t kDaysLocalised = 6;
constexpr int kLocalisedStride = 10;  // frames
constexpr int kPointsInView = 60;     // map points, from which a frame should be localised

// A recording that is being rendered has an extension.
std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> recordings;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (entry.is_directory() && !path.has_extension() && fs::exists(path / "mav0")) recordings.push_back(path);
  }
  std::ranges::sort(recordings);
  if (recordings.size() < 2) {
    throw InputError(folder.string(), "holds fewer than two recordings",
                     "render some: byre simulate life -o " + folder.string());
  }
  return recordings;
}

double megabytes(const fs::path& file) {
  return static_cast<double>(fs::file_size(file)) / kBytesPerMegabyte;
}

LifeMission measures_of(const RunResult& run, const MapAlignment& alignment, const Trajectory& poses) {
  constexpr double kClose = 0.05;  // metres
  const RunTruth truth{poses, alignment};
  const RunMeasures measures = evaluate_run(run, truth);
  const auto close =
      std::ranges::count_if(trace_of(run.causal, truth), [](const TracePoint& point) { return point.error <= kClose; });
  std::vector<double> inliers;
  for (const PlayedFrame& frame : run.frames) {
    if (frame.report) inliers.push_back(frame.report->health.offline_inliers);
  }
  return {.trusted = measures.behaviour.trusted_share.value_or(0.0),
          .within_5_cm = static_cast<double>(close) / static_cast<double>(run.frames.size()),
          .wrongly_trusted = static_cast<int>(measures.behaviour.wrongly_trusted.value_or(0.0)),
          .median_error = measures.causal_poses.map_error_median.value_or(0.0),
          .greatest_error = measures.causal_poses.map_error_max.value_or(0.0),
          .offline_inliers = median_or(std::move(inliers), 0.0)};
}

class LifeRunner {
 public:
  LifeRunner(const LifeCase& life, const LifeHooks& hooks)
      : life_(life), hooks_(hooks), recordings_(recordings_in(life.folder)) {}

  LifeResult run() {
    map_first_day();
    for (std::size_t day = 1; day < recordings_.size() && !hooks_.should_stop(); ++day) {
      LifeDay lived = live(recordings_[day]);
      if (hooks_.should_stop()) break;
      result_.days.push_back(std::move(lived));
      hooks_.after_day(result_);
    }
    if (!hooks_.should_stop()) result_.localisation = localise_last_days();
    result_.stopped = hooks_.should_stop();
    return std::move(result_);
  }

 private:
  SlamOptions slam_options_for(const fs::path& recording) const {
    SlamOptions options = slam_options(life_.method);
    options.recording = recording.filename().string();
    options.vocabulary = life_.vocabulary;
    return options;
  }

  RunResult play_through(Slam& slam, Recording& recording, const std::string& what) const {
    hooks_.before_run(what, recording.size());
    PlayHooks hooks;
    hooks.should_stop = hooks_.should_stop;
    hooks.after_frame = hooks_.after_frame;
    return play(slam, recording, hooks);
  }

  void map_first_day() {
    const fs::path& day = recordings_.front();
    const auto recording = open_recording(day, {});
    Slam slam = Slam::mapping(recording->calibration(), slam_options_for(day));
    RunResult run = play_through(slam, *recording, "map of " + day.filename().string());
    if (hooks_.should_stop()) return;
    if (run.final.empty()) throw InputError(day.string(), "gave no map", "see \"byre map\"");
    alignment_ = align_to_truth(run.final, Scale::fixed, load_truth(day));
    save_for_missions(std::move(run.stored), *slam.impl().inputs().vocabulary, "", first_);
    result_.first_map_mb = megabytes(first_);
  }

  LifeDay live(const fs::path& day) {
    LifeDay lived;
    lived.name = day.filename().string();
    const Trajectory truth = load_truth(day);
    lived.first = mission_on(first_, day, truth, lived.name + ", first version", nullptr);
    if (hooks_.should_stop()) return lived;
    const fs::path session = life_.output / (lived.name + ".session");
    fs::remove(session);
    lived.newest = mission_on(newest_, day, truth, lived.name + ", newest version", &session);
    if (hooks_.should_stop()) return lived;
    if (fs::exists(session)) update(session, lived);
    lived.map_mb = megabytes(newest_);
    return lived;
  }

  // Saves a session unless null or the mission mapped nothing.
  LifeMission mission_on(const fs::path& map, const fs::path& day, const Trajectory& truth, const std::string& what,
                         const fs::path* session) const {
    const auto recording = open_recording(day, {});
    Slam slam = Slam::on_map(recording->calibration(), map, slam_options_for(day));
    const RunResult run = play_through(slam, *recording, what);
    if (run.map_damage) throw InputError(*run.map_damage);
    if (session != nullptr && !hooks_.should_stop() && slam.impl().has_mapped()) slam.save_session(*session);
    return measures_of(run, alignment_, truth);
  }

  void update(const fs::path& session, LifeDay& lived) {
    const fs::path child = life_.output / (lived.name + ".byre");
    reset_peak_memory();
    const Stopwatch watch;
    lived.update = update_map_file(newest_, std::array{session}, child, life_.vocabulary);
    lived.update_seconds = watch.seconds();
    lived.update_memory_mb = peak_memory_mb().value_or(0.0);
    lived.session_mb = megabytes(session);
    if (lived.update->refusal.empty()) newest_ = child;
  }

  LifeLocalisation localise_last_days() const {
    const Vocabulary vocabulary = open_vocabulary(life_.vocabulary);
    const SearchableMap first(load_for_mapping(first_, vocabulary), vocabulary);
    const SearchableMap newest(load_for_mapping(newest_, vocabulary), vocabulary);
    LifeLocalisation all;
    std::map<std::array<int, 2>, std::vector<Pose>> changes;  // by place
    const std::size_t begin = recordings_.size() - std::min(kDaysLocalised, recordings_.size() - 1);
    for (std::size_t day = begin; day < recordings_.size() && !hooks_.should_stop(); ++day) {
      const std::vector<LocalisedFrame> by_first = localised(first, recordings_[day]);
      const std::vector<LocalisedFrame> by_newest = localised(newest, recordings_[day]);
      const Rig rig = Extractor(open_recording(recordings_[day], {})->calibration(), {}, {}).rig();
      const Trajectory truth = load_truth(recordings_[day]);
      for (std::size_t i = 0; i < std::min(by_first.size(), by_newest.size()); ++i) {
        ++all.frames;
        const std::optional<Pose> before = right_pose(by_first[i], first.map, rig, truth, all.first);
        const std::optional<Pose> now = right_pose(by_newest[i], newest.map, rig, truth, all.newest);
        if (!before || !now) continue;
        const Eigen::Vector2d place = (before->translation.head<2>() / 2.0).array().floor();
        changes[{static_cast<int>(place.x()), static_cast<int>(place.y())}].push_back(*now * inverse(*before));
      }
    }
    for (const auto& [place, poses] : changes) note_change(poses, all);
    return all;
  }

  std::vector<LocalisedFrame> localised(const SearchableMap& version, const fs::path& day) const {
    const auto recording = open_recording(day, FrameRange{.stride = kLocalisedStride});
    const LocaliseHooks hooks{.should_stop = hooks_.should_stop, .after_frame = [](int, const LocalisedFrame&) {}};
    return localise_recording({&version, 1}, *recording, hooks).frames;
  }

  static int points_in_view(const OfflineMap& map, const Rig& rig, const Pose& camera_from_map) {
    const auto points = points_of_place(map, keyframes_of_place(map, camera_from_map));
    return static_cast<int>(std::ranges::count_if(points, [&](PointId id) {
      const Eigen::Vector3d in_camera = camera_from_map * map.map().find_point(id)->position_in_world;
      return in_camera.z() > 0.0 && rig.contains(rig.project(in_camera).head<2>());
    }));
  }

  // The pose, counted; empty unless it is right.
  std::optional<Pose> right_pose(const LocalisedFrame& frame, const OfflineMap& map, const Rig& rig,
                                 const Trajectory& truth, VersionLocalisation& counts) const {
    const std::vector<PosePair> pairs = associate({{frame.time, Pose()}}, truth, {});
    if (pairs.empty()) return std::nullopt;
    const Pose map_from_body = inverse(alignment_.truth_from_map.target_from_source) * pairs[0].true_world_from_body;
    const bool is_in_view = points_in_view(map, rig, inverse(map_from_body * rig.body_from_camera)) >= kPointsInView;
    counts.in_view += is_in_view;
    if (!frame.world_from_body) return std::nullopt;
    const bool is_right = (frame.world_from_body->translation - map_from_body.translation).norm() <= kFarMetres;
    counts.found += is_right && is_in_view;
    counts.falsely += !is_right;
    return is_right ? frame.world_from_body : std::nullopt;
  }

  static void note_change(const std::vector<Pose>& newest_from_first, LifeLocalisation& all) {
    constexpr std::size_t kLeastFrames = 5;
    if (newest_from_first.size() < kLeastFrames) return;
    ++all.places;
    Eigen::Vector3d shift, turn;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> shifts, turns;
      for (const Pose& change : newest_from_first) {
        shifts.push_back(change.translation[axis]);
        turns.push_back(rotation_log(change.rotation)[axis]);
      }
      shift[axis] = median(std::move(shifts));
      turn[axis] = median(std::move(turns));
    }
    all.shift = std::max(all.shift, shift.norm());
    all.turn = std::max(all.turn, turn.norm() / kDegree);
  }

  // Constant after construction; borrowed.
  const LifeCase& life_;
  const LifeHooks& hooks_;

  const std::vector<fs::path> recordings_;
  const fs::path first_ = life_.output / "first.byre";
  fs::path newest_ = first_;
  MapAlignment alignment_;
  LifeResult result_;
};

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

LifeResult measure_life(const LifeCase& life, const LifeHooks& hooks) {
  return LifeRunner(life, hooks).run();
}

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
