#include "byre/slam/system/option_table.h"

#include "byre/base/nearest_name.h"
#include "byre/base/text_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <initializer_list>
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
MethodOption number(const char* name, const char* unit, double low, double high, Place place, const char* meaning) {
  using Number = std::remove_cvref_t<std::invoke_result_t<Place, MethodOptions&>>;
  const auto set = [=](MethodOptions& options, std::string_view text) {
    const auto value = from_text<Number>(text);
    if (!value || !(static_cast<double>(*value) >= low && static_cast<double>(*value) <= high)) return false;
    place(options) = *value;
    return true;
  };
  return {name,
          unit,
          "from " + in_full(low) + " to " + in_full(high),
          meaning,
          [=](const MethodOptions& options) { return to_text(place(options)); },
          set};
}

template <typename Place>
MethodOption flag(const char* name, Place place, const char* meaning) {
  const auto set = [=](MethodOptions& options, std::string_view text) {
    if (text != "true" && text != "false") return false;
    place(options) = text == "true";
    return true;
  };
  return {name,
          "",
          "true|false",
          meaning,
          [=](const MethodOptions& options) -> std::string { return place(options) ? "true" : "false"; },
          set};
}

template <typename Place, typename Value>
MethodOption choice(const char* name, std::initializer_list<Value> known, Place place, const char* meaning) {
  const std::vector<Value> values(known);
  std::string range;
  for (const Value value : values) range += (range.empty() ? "" : "|") + std::string(name_of(value));
  const auto set = [=](MethodOptions& options, std::string_view text) {
    const auto value = std::ranges::find(values, text, [](Value each) { return name_of(each); });
    if (value == values.end()) return false;
    place(options) = *value;
    return true;
  };
  return {name, "", range, meaning, [=](const MethodOptions& options) { return std::string(name_of(place(options))); },
          set};
}

using Table = std::vector<MethodOption>;

void add_run(Table& table) {
  table.push_back(choice(
      "pace", {Pace::same_thread, Pace::paced, Pace::live}, [](auto& o) -> auto& { return o.pace; },
      "thread of mapping, and feeding rate of recordings"));
  table.push_back(flag(
      "map_online", [](auto& o) -> auto& { return o.session.map_online; },
      "online mapping; false: a mission tracks the offline map only"));
  table.push_back(flag(
      "map.pictures", [](auto& o) -> auto& { return o.keep_pictures; },
      "small grey pictures of keyframes in a map being made, up to 12 kB each"));
  table.push_back(number(
      "trajectory.max_poses", "poses", 0, 1e8, [](auto& o) -> auto& { return o.session.trajectory.max_poses; },
      "maximum number of stored trajectory poses: the newer half is complete, older poses are thinned out evenly; 0: "
      "unlimited"));
  table.push_back(number(
      "frame.deadline_ms", "milliseconds", 0, 1e6, [](auto& o) -> auto& { return o.frame_deadline_ms; },
      "wall time limit per frame; to meet it, tracking skips online points first, then the right image; 0: no limit"));
}

void add_features(Table& table) {
  table.push_back(number(
      "features.max_count", "corners", 1, 1e5, [](auto& o) -> auto& { return o.extract.max_features; },
      "maximum number of corners per frame"));
  table.push_back(number(
      "features.fast_threshold_grey", "grey values", 1, 255, [](auto& o) -> auto& { return o.extract.fast_threshold; },
      "FAST threshold: contrast between a corner and its surroundings"));
  table.push_back(number(
      "features.min_fast_threshold_grey", "grey values", 1, 255,
      [](auto& o) -> auto& { return o.extract.min_fast_threshold; },
      "FAST threshold in image cells with too few corners at features.fast_threshold_grey"));
  table.push_back(number(
      "features.threads", "threads", 1, 64, [](auto& o) -> auto& { return o.extract.threads; },
      "threads of feature extraction per frame; results do not depend on the number"));
  table.push_back(number(
      "depth.max_m", "metres", 0.1, 1e3, [](auto& o) -> auto& { return o.extract.depth.max_depth; },
      "maximum depth used of a depth camera"));
  table.push_back(number(
      "depth.misalignment_px", "pixels", 0, 100, [](auto& o) -> auto& { return o.extract.depth.misalignment; },
      "maximum misregistration between depth image and colour image"));
}

void add_calibration(Table& table) {
  table.push_back(flag(
      "calibration.refine", [](auto& o) -> auto& { return o.self_calibrate; },
      "refinement of the given calibration by image measurements"));
  table.push_back(number(
      "calibration.prior_sigmas", "sigmas of a good calibration", 1e-3, 1e3,
      [](auto& o) -> auto& { return o.self_calibration.prior_sigmas; },
      "assumed error of the given calibration, prior of the refinement"));
  table.push_back(number(
      "calibration.max_keyframes", "keyframes", 6, 1e4,
      [](auto& o) -> auto& { return o.self_calibration.max_keyframes; },
      "maximum number of keyframes in the refinement; its time grows with the cube of the number"));
}

void add_start(Table& table) {
  table.push_back(number(
      "start.min_points", "points", 1, 1e5, [](auto& o) -> auto& { return o.session.min_initial_points; },
      "minimum number of stereo points of the first keyframe"));
}

void add_tracking(Table& table) {
  table.push_back(number(
      "tracking.local_keyframes", "keyframes", 1, 1e4, [](auto& o) -> auto& { return o.session.local_keyframes; },
      "keyframes of each map whose points are searched in a frame"));
  table.push_back(number(
      "tracking.search_radius_px", "pixels at octave 0", 0.5, 1e3,
      [](auto& o) -> auto& { return o.session.track.search_radius; },
      "radius of the first search around the predicted pixel"));
  table.push_back(number(
      "tracking.wide_radius_px", "pixels at octave 0", 0.5, 1e3,
      [](auto& o) -> auto& { return o.session.track.wide_radius; },
      "radius of the second search, used if the first one finds too few points"));
  table.push_back(number(
      "tracking.min_inliers", "points", 4, 1e5, [](auto& o) -> auto& { return o.session.track.min_inliers; },
      "minimum number of inliers of a tracked pose"));
  table.push_back(number(
      "tracking.min_kept_share", "share of the last frame's inliers", 0, 1,
      [](auto& o) -> auto& { return o.session.min_kept_share; },
      "share of inliers below which relocalisation without prediction runs as well"));
  table.push_back(number(
      "tracking.offline_weight", "weight of an online point", 1e-3, 1e3,
      [](auto& o) -> auto& { return o.session.track.offline_weight; },
      "weight of an observation of an offline point in tracking and mapping"));
}

void add_keyframes(Table& table) {
  table.push_back(number(
      "keyframes.min_tracked_share", "share of the reference keyframe's points", 0, 1,
      [](auto& o) -> auto& { return o.session.keyframes.min_tracked_share; },
      "share of tracked points below which a keyframe is created"));
  table.push_back(number(
      "keyframes.min_tracked", "points", 0, 1e5, [](auto& o) -> auto& { return o.session.keyframes.min_tracked; },
      "number of tracked points below which a keyframe is created at once"));
  table.push_back(number(
      "keyframes.max_turn_rad", "radians", 0, 4, [](auto& o) -> auto& { return o.session.keyframes.max_turn; },
      "rotation from the reference keyframe above which a keyframe is created"));
  table.push_back(number(
      "keyframes.max_shift_share", "share of the median depth", 0, 1e3,
      [](auto& o) -> auto& { return o.session.keyframes.max_shift_share; },
      "translation from the reference keyframe above which a keyframe is created"));
  table.push_back(number(
      "keyframes.min_frames", "frames", 0, 1e4, [](auto& o) -> auto& { return o.session.keyframes.min_frames; },
      "minimum number of frames between keyframes, unless tracking is about to fail"));
}

void add_mapping(Table& table) {
  table.push_back(number(
      "mapping.movable_keyframes", "keyframes", 1, 1e3, [](auto& o) -> auto& { return o.session.window.movable; },
      "online keyframes adjusted by one mapping job"));
  table.push_back(number(
      "mapping.anchor_keyframes", "keyframes", 0, 1e3, [](auto& o) -> auto& { return o.session.window.anchors; },
      "neighbouring online keyframes held fixed in a mapping job"));
  table.push_back(number(
      "mapping.offline_anchor_keyframes", "keyframes", 0, 1e3,
      [](auto& o) -> auto& { return o.session.window.offline_anchors; },
      "neighbouring offline keyframes held fixed in a mapping job"));
  table.push_back(number(
      "mapping.min_offline_sightings", "sightings", 0, kMany,
      [](auto& o) -> auto& { return o.session.window.min_offline_sightings; },
      "minimum number of offline point observations that fix the gauge"));
  table.push_back(number(
      "mapping.sightings_in_place_of_anchors", "sightings", 0, kMany,
      [](auto& o) -> auto& { return o.session.window.sightings_in_place_of_anchors; },
      "number of offline point observations from which online anchors are left out"));
  table.push_back(number(
      "mapping.max_relative_depth_sigma", "share of the depth", 1e-6, 10,
      [](auto& o) -> auto& { return o.session.max_relative_depth_sigma; },
      "maximum standard deviation of the depth of a new point"));
  table.push_back(number(
      "mapping.redundant_share", "share of a keyframe's points", 0, 1,
      [](auto& o) -> auto& { return o.session.redundant_share; },
      "share of points that are offline or seen by three other keyframes, above which a keyframe is removed"));
}

void add_localisation(Table& table) {
  table.push_back(number(
      "localisation.min_inliers", "points", 4, kMany, [](auto& o) -> auto& { return o.session.relocalise.min_inliers; },
      "minimum number of inliers of a pose found without prediction"));
  table.push_back(number(
      "localisation.min_spread", "share of the image's diagonal", 0, 1,
      [](auto& o) -> auto& { return o.session.relocalise.min_spread; },
      "minimum standard deviation of the inliers in their narrowest direction"));
  table.push_back(number(
      "localisation.max_position_sigma", "share of the median depth", 0, 100,
      [](auto& o) -> auto& { return o.session.relocalise.max_position_sigma; },
      "maximum standard deviation of position of a pose found without prediction"));
  table.push_back(number(
      "localisation.max_rotation_sigma_rad", "radians", 0, 10,
      [](auto& o) -> auto& { return o.session.relocalise.max_rotation_sigma; },
      "maximum standard deviation of rotation of a pose found without prediction"));
  table.push_back(number(
      "localisation.seed", "", 0, 1e15, [](auto& o) -> auto& { return o.session.relocalise.seed; },
      "seed of the random samples of P3P RANSAC"));
}

void add_loops(Table& table) {
  table.push_back(flag(
      "loops.close", [](auto& o) -> auto& { return o.close_loops; },
      "place recognition in the map being made, and its finishing; false: for comparison"));
  table.push_back(number(
      "loops.min_gap_keyframes", "keyframes", 1, kMany, [](auto& o) -> auto& { return o.session.loops.min_gap; },
      "minimum number of keyframes between the newest keyframe and a loop candidate"));
  table.push_back(number(
      "loops.max_drift_share", "share of the path", 0, 10,
      [](auto& o) -> auto& { return o.session.loops.max_drift_share; }, "maximum drift that a loop corrects"));
  table.push_back(number(
      "loops.max_drift_m", "metres", 0, 1e3, [](auto& o) -> auto& { return o.session.loops.max_drift; },
      "maximum drift that a loop corrects, added to loops.max_drift_share"));
  table.push_back(number(
      "loops.max_scale_drift", "natural logarithm of the scale", 0, 10,
      [](auto& o) -> auto& { return o.session.loops.max_scale_drift; }, "maximum scale drift of a monocular loop"));
  table.push_back(number(
      "loops.max_scale_sigma", "natural logarithm of the scale", 0, 10,
      [](auto& o) -> auto& { return o.session.loops.max_scale_sigma; },
      "maximum standard deviation of the scale drift"));
  table.push_back(number(
      "loops.min_scale_points", "points", 1, kMany, [](auto& o) -> auto& { return o.session.loops.min_scale_points; },
      "minimum number of points common to both ends of a loop for its scale drift"));
  table.push_back(number(
      "loops.max_drift_to_fuse_px", "pixels", 0, 1e3, [](auto& o) -> auto& { return o.session.max_drift_to_fuse; },
      "drift up to which a loop only fuses points, without pose graph optimisation"));
}

void add_mission(Table& table) {
  table.push_back(number(
      "mission.search_after_m", "metres", 0, 1e3, [](auto& o) -> auto& { return o.session.mission.search_after; },
      "path without offline points after which places are searched in parallel to tracking"));
  table.push_back(number(
      "mission.restart_after_s", "seconds", 0, 1e5, [](auto& o) -> auto& { return o.session.mission.restart_after; },
      "time without a pose after which a new online submap starts"));
  table.push_back(number(
      "mission.lost_after_s", "seconds", 0, 1e5, [](auto& o) -> auto& { return o.session.state.lost_after; },
      "time without a confirmed pose after which a navigation error is reported"));
  table.push_back(number(
      "mission.max_speed_m_per_s", "metres a second", 0, 100,
      [](auto& o) -> auto& { return o.session.mission.registration.max_speed; }, "maximum speed of the robot"));
  table.push_back(number(
      "mission.confirmations", "frames", 1, 1e3,
      [](auto& o) -> auto& { return o.session.mission.registration.confirmations; },
      "consistent frames required before mapping uses a place in the offline map"));
  table.push_back(number(
      "mission.max_misses", "frames", 0, 1e3,
      [](auto& o) -> auto& { return o.session.mission.registration.max_misses; },
      "contradicting frames after which a place is dropped"));
  table.push_back(number(
      "mission.accept_log_odds", "nats", 0, 1e3,
      [](auto& o) -> auto& { return o.session.mission.registration.accept_log_odds; },
      "log-odds of a place, over the map cells in view, from which it is accepted"));
  table.push_back(number(
      "mission.plane_margin_m", "metres", 0, 1e3,
      [](auto& o) -> auto& { return o.session.mission.bounds.plane_margin; },
      "distance from the map's driving plane above which a place is rejected, in addition to its uncertainty"));
  table.push_back(number(
      "mission.plane_margin_rad", "radians", 0, 4,
      [](auto& o) -> auto& { return o.session.mission.bounds.plane_margin_tilt; },
      "tilt against the map's driving plane above which a place is rejected, in addition to its uncertainty"));
  table.push_back(number(
      "mission.wall_margin_m", "metres", 0, 1e3, [](auto& o) -> auto& { return o.session.mission.bounds.wall_margin; },
      "distance behind a wall of the floor plan above which a place is rejected, in addition to its uncertainty"));
  table.push_back(number(
      "mission.min_offline_inliers", "points", 1, 1e5,
      [](auto& o) -> auto& { return o.session.mission.view.min_inliers; },
      "minimum number of offline inliers that constrain a pose"));
  table.push_back(number(
      "mission.min_offline_expected", "points", 1, 1e5,
      [](auto& o) -> auto& { return o.session.mission.view.min_expected; },
      "number of offline points in view below which the robot is off the map"));
  table.push_back(number(
      "mission.min_features", "corners", 0, 1e5, [](auto& o) -> auto& { return o.session.mission.view.min_features; },
      "number of corners below which the camera is blinded"));
  table.push_back(number(
      "mission.frames_to_suspend", "frames", 1, 3e4,
      [](auto& o) -> auto& { return o.session.mission.moved_points.frames; },
      "excess of frames with an offline point at another place over frames with it in place, from which it is "
      "suspended"));
  table.push_back(number(
      "mission.frames_to_return", "frames", 1, 3e4,
      [](auto& o) -> auto& { return o.session.mission.moved_points.frames_to_return; },
      "consecutive frames with a suspended point in its place after which it is used again"));
  table.push_back(number(
      "mission.hindsight_frames", "frames", 0, kMany,
      [](auto& o) -> auto& { return o.session.deferred_refinement.frames; },
      "maximum number of frames refined in hindsight; 10 kB each"));
}

void add_motion(Table& table) {
  table.push_back(flag(
      "motion.planar", [](auto& o) -> auto& { return o.session.is_planar; },
      "height, roll and pitch constrained to the driving plane of the offline map"));
  table.push_back(flag(
      "motion.known_mounting", [](auto& o) -> auto& { return o.use_saved_extrinsics; },
      "extrinsics of wheels and gyroscope initialised from the offline map, until measurements contradict them"));
  table.push_back(number(
      "motion.max_speed_m_per_s", "metres a second", 0.01, 1e3,
      [](auto& o) -> auto& { return o.motion_limits.max_speed; },
      "maximum speed of the robot's base: faster wheel samples are dropped; if most are faster, wheels are ignored"));
  table.push_back(number(
      "motion.max_turn_rate_rad_per_s", "radians a second", 0.01, 1e3,
      [](auto& o) -> auto& { return o.motion_limits.max_turn_rate; },
      "maximum turn rate of base and gyroscope: faster samples are dropped; if most are faster, the gyroscope is "
      "ignored"));
  table.push_back(number(
      "motion.max_acceleration_m_per_s2", "m/s^2", 10, 1e4,
      [](auto& o) -> auto& { return o.motion_limits.max_acceleration; },
      "maximum acceleration measured by the accelerometer: larger samples are dropped"));
  table.push_back(number(
      "motion.max_position_m", "metres", 1, 1e9, [](auto& o) -> auto& { return o.motion_limits.max_position; },
      "distance from the origin of wheel odometry beyond which a pose is dropped"));
  table.push_back(number(
      "motion.wheel_scale_sigma", "share of the length", 0, 1, [](auto& o) -> auto& { return o.wheel_scale_sigma; },
      "standard deviation of the metric scale that wheels give a monocular map, added to that of the fit"));
}

void add_health(Table& table) {
  table.push_back(number(
      "health.trusted_error_m", "metres", 1e-6, 1e3, [](auto& o) -> auto& { return o.session.health.trusted_error; },
      "maximum position error of a trusted pose"));
  table.push_back(number(
      "health.sigmas", "sigmas", 0, 100, [](auto& o) -> auto& { return o.session.health.sigmas; },
      "number of standard deviations of position that must be within health.trusted_error_m"));
  table.push_back(number(
      "health.drift_share", "share of the path", 0, 1, [](auto& o) -> auto& { return o.session.health.drift_share; },
      "assumed drift since the last pose constrained by offline points"));
  table.push_back(number(
      "health.max_rotation_sigma_rad", "radians", 0, 10,
      [](auto& o) -> auto& { return o.session.health.max_rotation_sigma; },
      "maximum standard deviation of rotation of a trusted pose"));
  table.push_back(number(
      "health.max_bridged_rotation_rad", "radians", 0, 10,
      [](auto& o) -> auto& { return o.session.health.max_bridged_rotation; },
      "maximum rotation error of a degraded pose during dead reckoning"));
  table.push_back(number(
      "health.min_points", "points", 0, 1e5, [](auto& o) -> auto& { return o.session.health.min_points; },
      "minimum number of inliers of both maps together of a trusted pose"));
  table.push_back(number(
      "health.min_spread", "share of the image's diagonal", 0, 1,
      [](auto& o) -> auto& { return o.session.health.min_spread; },
      "minimum standard deviation of the inliers in their narrowest direction"));
  table.push_back(number(
      "health.max_disagreement_m", "metres", 0, 1e3, [](auto& o) -> auto& { return o.session.health.max_disagreement; },
      "maximum distance between the pose by offline points and the pose by online points"));
  table.push_back(number(
      "health.min_offline_points", "points", 0, 1e5,
      [](auto& o) -> auto& { return o.session.health.min_offline_points; },
      "minimum number of offline inliers of a trusted pose if many offline points are in view"));
  table.push_back(number(
      "health.max_changed_path_m", "metres", 0, 1e5, [](auto& o) -> auto& { return o.session.health.max_changed_path; },
      "path with fewer offline inliers that is tolerated"));
  table.push_back(number(
      "health.max_frozen_s", "seconds", 0, 1e3, [](auto& o) -> auto& { return o.session.health.max_frozen; },
      "time with an unchanged image from which poses are untrusted"));
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
      "contrast below which an image is low in contrast"));
  table.push_back(number(
      "image.min_sharpness", "share of the contrast", 0, 10,
      [](auto& o) -> auto& { return o.session.image.min_sharpness; }, "sharpness below which an image is blurred"));
}

}  // namespace

const std::vector<MethodOption>& option_table() {
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

std::vector<std::pair<std::string, std::string>> changed_options(const MethodOptions& options) {
  std::vector<std::pair<std::string, std::string>> changed;
  for (const MethodOption& option : option_table()) {
    const std::string value = option.get(options);
    if (value != option.get({})) changed.emplace_back(option.name, value);
  }
  return changed;
}

SlamOptions slam_options(const MethodOptions& options) {
  SlamOptions slam;
  for (const MethodOption& option : option_table()) slam.settings.emplace_back(option.name, option.get(options));
  return slam;
}

std::optional<OptionFault> set_option(MethodOptions& options, std::string_view name, std::string_view text) {
  const Table& table = option_table();
  const auto option = std::ranges::find(table, name, &MethodOption::name);
  if (option == table.end()) {
    std::vector<std::string> names;
    for (const MethodOption& known : table) names.push_back(known.name);
    const auto nearest = nearest_name(name, names);
    return OptionFault{"unknown option '" + std::string(name) + "'",
                       nearest ? "did you mean '" + *nearest + "'?" : "see docs/reference/options.md"};
  }
  if (option->set(options, text)) return std::nullopt;
  const std::string unit = option->unit.empty() ? "" : ", in " + option->unit;
  return OptionFault{"'" + std::string(text) + "' is not a value of " + option->name, "give " + option->range + unit};
}

}  // namespace byre
