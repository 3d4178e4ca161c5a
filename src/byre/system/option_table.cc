#include "byre/system/option_table.h"

#include "byre/input/text_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <initializer_list>
#include <numeric>
#include <type_traits>
#include <utility>

namespace byre {
namespace {

constexpr double kMany = 1e6;

template <typename Number>
std::string to_text(Number value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

// Bound without an exponent.
std::string in_full(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed).ptr;
  return {text.data(), end};
}

// Integers in plain notation, others in any notation.
template <typename Number>
std::optional<Number> from_text(std::string_view text) {
  if constexpr (std::is_floating_point_v<Number>) {
    const auto number = parse_number(text);
    return number ? std::optional(static_cast<Number>(*number)) : std::nullopt;
  } else {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
  }
}

// place: accessor of the member, for constant and mutable options.
template <typename Place>
EngineOption number(const char* name, const char* unit, double low, double high, Place place, const char* meaning) {
  using Number = std::remove_cvref_t<std::invoke_result_t<Place, EngineOptions&>>;
  const auto set = [=](EngineOptions& options, std::string_view text) {
    const auto value = from_text<Number>(text);
    if (!value || !(static_cast<double>(*value) >= low && static_cast<double>(*value) <= high)) return false;
    place(options) = *value;
    return true;
  };
  return {name,
          unit,
          "from " + in_full(low) + " to " + in_full(high),
          meaning,
          [=](const EngineOptions& options) { return to_text(place(options)); },
          set};
}

template <typename Place>
EngineOption flag(const char* name, Place place, const char* meaning) {
  const auto set = [=](EngineOptions& options, std::string_view text) {
    if (text != "true" && text != "false") return false;
    place(options) = text == "true";
    return true;
  };
  return {name,
          "",
          "true|false",
          meaning,
          [=](const EngineOptions& options) -> std::string { return place(options) ? "true" : "false"; },
          set};
}

template <typename Place, typename Value>
EngineOption choice(const char* name, std::initializer_list<Value> known, Place place, const char* meaning) {
  const std::vector<Value> values(known);
  std::string range;
  for (const Value value : values) range += (range.empty() ? "" : "|") + std::string(name_of(value));
  const auto set = [=](EngineOptions& options, std::string_view text) {
    const auto value = std::ranges::find(values, text, [](Value each) { return name_of(each); });
    if (value == values.end()) return false;
    place(options) = *value;
    return true;
  };
  return {name, "", range, meaning, [=](const EngineOptions& options) { return std::string(name_of(place(options))); },
          set};
}

using Table = std::vector<EngineOption>;

void add_run(Table& table) {
  table.push_back(choice(
      "pace", {Pace::same_thread, Pace::paced, Pace::live}, [](auto& o) -> auto& { return o.pace; },
      "place of mapping, and pace at which recordings are fed"));
  table.push_back(flag(
      "map_online", [](auto& o) -> auto& { return o.session.map_online; },
      "mapping of what is new; without it a mission tracks the offline map alone"));
  table.push_back(number(
      "trajectory.max_poses", "poses", 0, 1e8, [](auto& o) -> auto& { return o.session.trajectory.max_poses; },
      "most poses of the trajectory that are kept: the newer half, older ones evenly thinned out; 0: all"));
  table.push_back(number(
      "frame.deadline_ms", "milliseconds", 0, 1e6, [](auto& o) -> auto& { return o.frame_deadline_ms; },
      "wall time that a frame may take: where it would take longer, online points are left out first, then the right "
      "image; 0: as long as it needs"));
}

void add_features(Table& table) {
  table.push_back(number(
      "features.max_count", "corners", 1, 1e5, [](auto& o) -> auto& { return o.extract.max_features; },
      "most corners of a frame"));
  table.push_back(number(
      "features.fast_threshold_grey", "grey values", 1, 255, [](auto& o) -> auto& { return o.extract.fast_threshold; },
      "contrast of a corner against its surroundings"));
  table.push_back(number(
      "features.min_fast_threshold_grey", "grey values", 1, 255,
      [](auto& o) -> auto& { return o.extract.min_fast_threshold; }, "the same where the image is dull"));
  table.push_back(choice(
      "features.refinement", {Refinement::none, Refinement::stereo, Refinement::all},
      [](auto& o) -> auto& { return o.extract.refinement; }, "matches refined in the image"));
  table.push_back(number(
      "features.threads", "threads", 1, 64, [](auto& o) -> auto& { return o.extract.threads; },
      "threads that work on the images of one frame; results do not depend on them"));
  table.push_back(number(
      "depth.max_m", "metres", 0.1, 1e3, [](auto& o) -> auto& { return o.extract.depth.max_depth; },
      "farthest depth of a depth camera that is used"));
  table.push_back(number(
      "depth.misalignment_px", "pixels", 0, 100, [](auto& o) -> auto& { return o.extract.depth.misalignment; },
      "distance by which depths may lie beside what they are of"));
}

void add_calibration(Table& table) {
  table.push_back(flag(
      "calibration.refine", [](auto& o) -> auto& { return o.self_calibrate; },
      "refinement of the calibration given by what is seen"));
  table.push_back(number(
      "calibration.prior_sigmas", "sigmas of a good calibration", 1e-3, 1e3,
      [](auto& o) -> auto& { return o.self_calibration.prior_sigmas; },
      "error of the calibration given, as taken at first"));
  table.push_back(number(
      "calibration.max_keyframes", "keyframes", 6, 1e4,
      [](auto& o) -> auto& { return o.self_calibration.max_keyframes; },
      "keyframes that refinement works on; its time grows with their cube"));
}

void add_start(Table& table) {
  table.push_back(number(
      "start.min_points", "points", 1, 1e5, [](auto& o) -> auto& { return o.session.min_initial_points; },
      "stereo points of the first keyframe"));
}

void add_tracking(Table& table) {
  table.push_back(number(
      "tracking.local_keyframes", "keyframes", 1, 1e4, [](auto& o) -> auto& { return o.session.local_keyframes; },
      "keyframes of either map whose points are looked for in a frame"));
  table.push_back(number(
      "tracking.search_radius_px", "pixels at octave 0", 0.5, 1e3,
      [](auto& o) -> auto& { return o.session.track.search_radius; }, "first search about the predicted pixel"));
  table.push_back(number(
      "tracking.wide_radius_px", "pixels at octave 0", 0.5, 1e3,
      [](auto& o) -> auto& { return o.session.track.wide_radius; }, "second search, where the first finds too little"));
  table.push_back(number(
      "tracking.min_inliers", "points", 4, 1e5, [](auto& o) -> auto& { return o.session.track.min_inliers; },
      "points that a tracked pose fits"));
  table.push_back(number(
      "tracking.min_kept_share", "share of the last frame's inliers", 0, 1,
      [](auto& o) -> auto& { return o.session.min_kept_share; },
      "inliers below which the pose is sought without prediction too"));
  table.push_back(choice(
      "tracking.offline_policy", {OfflinePolicy::first, OfflinePolicy::together},
      [](auto& o) -> auto& { return o.session.track.offline_policy; },
      "offline points before online ones, or both together"));
  table.push_back(number(
      "tracking.offline_weight", "weight of an online point", 1e-3, 1e3,
      [](auto& o) -> auto& { return o.session.track.offline_weight; },
      "weight of a measured offline point, in tracking and in mapping"));
}

void add_keyframes(Table& table) {
  table.push_back(number(
      "keyframes.min_tracked_share", "share of the reference keyframe's points", 0, 1,
      [](auto& o) -> auto& { return o.session.keyframes.min_tracked_share; },
      "points tracked below which a keyframe is made"));
  table.push_back(number(
      "keyframes.min_tracked", "points", 0, 1e5, [](auto& o) -> auto& { return o.session.keyframes.min_tracked; },
      "points tracked below which a keyframe is made at once"));
  table.push_back(number(
      "keyframes.max_turn_rad", "radians", 0, 4, [](auto& o) -> auto& { return o.session.keyframes.max_turn; },
      "turn from the reference keyframe above which a keyframe is made"));
  table.push_back(number(
      "keyframes.max_shift_share", "share of the median depth", 0, 1e3,
      [](auto& o) -> auto& { return o.session.keyframes.max_shift_share; },
      "shift from the reference keyframe above which a keyframe is made"));
  table.push_back(number(
      "keyframes.min_frames", "frames", 0, 1e4, [](auto& o) -> auto& { return o.session.keyframes.min_frames; },
      "frames between keyframes, unless tracking is about to fail"));
}

void add_mapping(Table& table) {
  table.push_back(number(
      "mapping.movable_keyframes", "keyframes", 1, 1e3, [](auto& o) -> auto& { return o.session.window.movable; },
      "online keyframes that one mapping job adjusts"));
  table.push_back(number(
      "mapping.anchor_keyframes", "keyframes", 0, 1e3, [](auto& o) -> auto& { return o.session.window.anchors; },
      "online keyframes around those, held fixed"));
  table.push_back(number(
      "mapping.offline_anchor_keyframes", "keyframes", 0, 1e3,
      [](auto& o) -> auto& { return o.session.window.offline_anchors; }, "offline keyframes around those, held fixed"));
  table.push_back(number(
      "mapping.min_offline_sightings", "sightings", 0, kMany,
      [](auto& o) -> auto& { return o.session.window.min_offline_sightings; },
      "sightings of offline points that hold the world in place"));
  table.push_back(number(
      "mapping.sightings_in_place_of_anchors", "sightings", 0, kMany,
      [](auto& o) -> auto& { return o.session.window.sightings_in_place_of_anchors; },
      "sightings of offline points from which online anchors are left out"));
  table.push_back(number(
      "mapping.max_relative_depth_sigma", "share of the depth", 1e-6, 10,
      [](auto& o) -> auto& { return o.session.max_relative_depth_sigma; }, "uncertainty of a new point's depth"));
  table.push_back(number(
      "mapping.redundant_share", "share of a keyframe's points", 0, 1,
      [](auto& o) -> auto& { return o.session.redundant_share; },
      "points known without a keyframe above which it is removed"));
}

void add_localisation(Table& table) {
  table.push_back(number(
      "localisation.min_inliers", "points", 4, kMany, [](auto& o) -> auto& { return o.session.relocalise.min_inliers; },
      "points that a pose found from nothing fits"));
  table.push_back(number(
      "localisation.min_spread", "share of the image's diagonal", 0, 1,
      [](auto& o) -> auto& { return o.session.relocalise.min_spread; }, "deviation of those where they spread least"));
  table.push_back(number(
      "localisation.max_position_sigma", "share of the median depth", 0, 100,
      [](auto& o) -> auto& { return o.session.relocalise.max_position_sigma; },
      "uncertainty of such a pose's position"));
  table.push_back(number(
      "localisation.max_rotation_sigma_rad", "radians", 0, 10,
      [](auto& o) -> auto& { return o.session.relocalise.max_rotation_sigma; },
      "uncertainty of such a pose's rotation"));
  table.push_back(number(
      "localisation.seed", "", 0, 1e15, [](auto& o) -> auto& { return o.session.relocalise.seed; },
      "seed of the poses that are tried from three points"));
}

void add_loops(Table& table) {
  table.push_back(number(
      "loops.min_gap_keyframes", "keyframes", 1, kMany, [](auto& o) -> auto& { return o.session.loops.min_gap; },
      "keyframes between a place and the newest, for a loop"));
  table.push_back(number(
      "loops.max_drift_share", "share of the path", 0, 10,
      [](auto& o) -> auto& { return o.session.loops.max_drift_share; }, "drift that a loop may correct"));
  table.push_back(number(
      "loops.max_drift_m", "metres", 0, 1e3, [](auto& o) -> auto& { return o.session.loops.max_drift; },
      "drift that a loop may correct, on top of that share"));
  table.push_back(number(
      "loops.max_scale_drift", "natural logarithm of the scale", 0, 10,
      [](auto& o) -> auto& { return o.session.loops.max_scale_drift; }, "drift of scale without stereo"));
  table.push_back(number(
      "loops.max_scale_sigma", "natural logarithm of the scale", 0, 10,
      [](auto& o) -> auto& { return o.session.loops.max_scale_sigma; }, "uncertainty of that drift"));
  table.push_back(number(
      "loops.min_scale_points", "points", 1, kMany, [](auto& o) -> auto& { return o.session.loops.min_scale_points; },
      "points in both parts of a map that tell that drift"));
  table.push_back(number(
      "loops.max_drift_to_fuse_px", "pixels", 0, 1e3, [](auto& o) -> auto& { return o.session.max_drift_to_fuse; },
      "drift up to which points are fused and the map is not bent"));
}

void add_mission(Table& table) {
  table.push_back(number(
      "mission.search_after_m", "metres", 0, 1e3, [](auto& o) -> auto& { return o.session.mission.search_after; },
      "path without offline points from which places are looked for beside tracking"));
  table.push_back(number(
      "mission.restart_after_s", "seconds", 0, 1e5, [](auto& o) -> auto& { return o.session.mission.restart_after; },
      "time without a pose from which a new piece of online map is begun"));
  table.push_back(number(
      "mission.lost_after_s", "seconds", 0, 1e5, [](auto& o) -> auto& { return o.session.state.lost_after; },
      "time without a confirmed pose from which a navigation error is told"));
  table.push_back(number(
      "mission.max_speed_m_per_s", "metres a second", 0, 100,
      [](auto& o) -> auto& { return o.session.mission.registration.max_speed; }, "highest speed of the robot"));
  table.push_back(number(
      "mission.confirmations", "frames", 1, 1e3,
      [](auto& o) -> auto& { return o.session.mission.registration.confirmations; },
      "frames that must say the same before a place in the offline map is believed"));
  table.push_back(number(
      "mission.max_misses", "frames", 0, 1e3,
      [](auto& o) -> auto& { return o.session.mission.registration.max_misses; },
      "frames that say something else before such a place is given up"));
  table.push_back(number(
      "mission.accept_log_odds", "nats", 0, 1e3,
      [](auto& o) -> auto& { return o.session.mission.registration.accept_log_odds; },
      "log-odds of a place found, by the map cells in view, from which it is trusted"));
  table.push_back(number(
      "mission.plane_margin_m", "metres", 0, 1e3,
      [](auto& o) -> auto& { return o.session.mission.bounds.plane_margin; },
      "height off the driving plane of the map from which a place found is refused, beyond what is uncertain"));
  table.push_back(number(
      "mission.plane_margin_rad", "radians", 0, 4,
      [](auto& o) -> auto& { return o.session.mission.bounds.plane_margin_tilt; }, "tilt against it, likewise"));
  table.push_back(number(
      "mission.wall_margin_m", "metres", 0, 1e3, [](auto& o) -> auto& { return o.session.mission.bounds.wall_margin; },
      "distance behind a wall of the floor plan from which a place found is refused, beyond what is uncertain"));
  table.push_back(number(
      "mission.min_offline_inliers", "points", 1, 1e5,
      [](auto& o) -> auto& { return o.session.mission.view.min_inliers; }, "offline points that hold a pose"));
  table.push_back(number(
      "mission.min_offline_expected", "points", 1, 1e5,
      [](auto& o) -> auto& { return o.session.mission.view.min_expected; },
      "offline points in view below which the robot is off the map"));
  table.push_back(number(
      "mission.min_features", "corners", 0, 1e5, [](auto& o) -> auto& { return o.session.mission.view.min_features; },
      "corners below which the camera is blinded"));
  table.push_back(number(
      "mission.frames_to_suspend", "frames", 1, 3e4,
      [](auto& o) -> auto& { return o.session.mission.moved_points.frames; },
      "frames by which an offline point was found elsewhere more often than in its place"));
  table.push_back(number(
      "mission.frames_to_return", "frames", 1, 3e4,
      [](auto& o) -> auto& { return o.session.mission.moved_points.frames_to_return; },
      "frames in a row that show a suspended point in its place again"));
  table.push_back(number(
      "mission.hindsight_frames", "frames", 0, kMany, [](auto& o) -> auto& { return o.session.hindsight.frames; },
      "frames that are refined at the end; 10 kB each"));
}

void add_motion(Table& table) {
  table.push_back(flag(
      "motion.planar", [](auto& o) -> auto& { return o.session.is_planar; },
      "height, roll and pitch of a mission held to the ground that its map was driven on"));
  table.push_back(flag(
      "motion.known_mounting", [](auto& o) -> auto& { return o.use_known_mounting; },
      "wheels and gyroscope taken to be mounted as when the map was made, until they tell otherwise"));
  table.push_back(number(
      "motion.max_speed_m_per_s", "metres a second", 0.01, 1e3,
      [](auto& o) -> auto& { return o.motion_limits.max_speed; },
      "highest speed of the robot's base: faster wheel samples are dropped; if most are, wheels are ignored"));
  table.push_back(number(
      "motion.max_turn_rate_rad_per_s", "radians a second", 0.01, 1e3,
      [](auto& o) -> auto& { return o.motion_limits.max_turn_rate; },
      "highest turn rate of base and gyroscope: faster samples are dropped; if most rates are, the gyroscope is "
      "ignored"));
  table.push_back(number(
      "motion.max_acceleration_m_per_s2", "m/s^2", 10, 1e4,
      [](auto& o) -> auto& { return o.motion_limits.max_acceleration; },
      "largest acceleration by the accelerometer: larger ones are dropped"));
  table.push_back(number(
      "motion.max_position_m", "metres", 1, 1e9, [](auto& o) -> auto& { return o.motion_limits.max_position; },
      "distance from the origin of wheel odometry beyond which a pose is dropped"));
  table.push_back(number(
      "motion.wheel_scale_sigma", "share of the length", 0, 1, [](auto& o) -> auto& { return o.wheel_scale_sigma; },
      "standard deviation of metres that wheels alone measure for a map by one camera, added to that of the fit"));
}

void add_health(Table& table) {
  table.push_back(number(
      "health.trusted_error_m", "metres", 1e-6, 1e3, [](auto& o) -> auto& { return o.session.health.trusted_error; },
      "position error that a trusted pose promises to stay within"));
  table.push_back(number(
      "health.sigmas", "sigmas", 0, 100, [](auto& o) -> auto& { return o.session.health.sigmas; },
      "uncertainty of the pose that must fit into that"));
  table.push_back(number(
      "health.drift_share", "share of the path", 0, 1, [](auto& o) -> auto& { return o.session.health.drift_share; },
      "drift since offline points last held the pose, as taken"));
  table.push_back(number(
      "health.max_rotation_sigma_rad", "radians", 0, 10,
      [](auto& o) -> auto& { return o.session.health.max_rotation_sigma; },
      "uncertainty of a trusted pose's rotation"));
  table.push_back(number(
      "health.max_bridged_rotation_rad", "radians", 0, 10,
      [](auto& o) -> auto& { return o.session.health.max_bridged_rotation; },
      "error of a bridged pose's rotation, up to which it is degraded"));
  table.push_back(number(
      "health.min_points", "points", 0, 1e5, [](auto& o) -> auto& { return o.session.health.min_points; },
      "points of either map that hold a trusted pose"));
  table.push_back(number(
      "health.min_spread", "share of the image's diagonal", 0, 1,
      [](auto& o) -> auto& { return o.session.health.min_spread; }, "deviation of those where they spread least"));
  table.push_back(number(
      "health.max_disagreement_m", "metres", 0, 1e3, [](auto& o) -> auto& { return o.session.health.max_disagreement; },
      "distance between the poses by offline and by online points"));
  table.push_back(number(
      "health.min_offline_points", "points", 0, 1e5,
      [](auto& o) -> auto& { return o.session.health.min_offline_points; },
      "offline points of a trusted pose where many are in view"));
  table.push_back(number(
      "health.max_changed_path_m", "metres", 0, 1e5, [](auto& o) -> auto& { return o.session.health.max_changed_path; },
      "path with fewer of them that is let pass"));
  table.push_back(number(
      "health.max_frozen_s", "seconds", 0, 1e3, [](auto& o) -> auto& { return o.session.health.max_frozen; },
      "time of one and the same image from which no pose is trusted"));
}

void add_image(Table& table) {
  table.push_back(number(
      "image.min_brightness_grey", "grey values", 0, 255,
      [](auto& o) -> auto& { return o.session.image.min_brightness; }, "brightness below which an image is dark"));
  table.push_back(number(
      "image.max_brightness_grey", "grey values", 0, 255,
      [](auto& o) -> auto& { return o.session.image.max_brightness; },
      "brightness above which an image is overexposed"));
  table.push_back(number(
      "image.min_contrast_grey", "grey values", 0, 255, [](auto& o) -> auto& { return o.session.image.min_contrast; },
      "contrast below which an image shows too little"));
  table.push_back(number(
      "image.min_sharpness", "share of the contrast", 0, 10,
      [](auto& o) -> auto& { return o.session.image.min_sharpness; }, "sharpness below which an image is blurred"));
}

// Levenshtein distance.
std::size_t distance_between(std::string_view one, std::string_view other) {
  std::vector<std::size_t> row(other.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < one.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < other.size(); ++j) {
      const std::size_t exchanged = diagonal + (one[i] == other[j] ? 0 : 1);
      diagonal = std::exchange(row[j + 1], std::min({row[j] + 1, row[j + 1] + 1, exchanged}));
    }
  }
  return row.back();
}

}  // namespace

const std::vector<EngineOption>& option_table() {
  static const Table table = [] {
    Table all;
    for (const auto add : {add_run, add_features, add_calibration, add_start, add_tracking, add_keyframes, add_mapping,
                           add_localisation, add_loops, add_mission, add_motion, add_health, add_image}) {
      add(all);
    }
    return all;
  }();
  return table;
}

std::vector<std::pair<std::string, std::string>> changed_options(const EngineOptions& options) {
  std::vector<std::pair<std::string, std::string>> changed;
  for (const EngineOption& option : option_table()) {
    const std::string value = option.get(options);
    if (value != option.get({})) changed.emplace_back(option.name, value);
  }
  return changed;
}

std::optional<OptionFault> set_option(EngineOptions& options, std::string_view name, std::string_view text) {
  const Table& table = option_table();
  const auto option = std::ranges::find(table, name, &EngineOption::name);
  if (option == table.end()) {
    const auto like = std::ranges::min_element(
        table, {}, [&](const EngineOption& known) { return distance_between(known.name, name); });
    return OptionFault{"there is no option '" + std::string(name) + "'", "did you mean '" + like->name + "'?"};
  }
  if (option->set(options, text)) return std::nullopt;
  const std::string unit = option->unit.empty() ? "" : ", in " + option->unit;
  return OptionFault{"'" + std::string(text) + "' is no value of " + option->name, "give " + option->range + unit};
}

}  // namespace byre
