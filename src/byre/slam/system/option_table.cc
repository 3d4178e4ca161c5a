#include "byre/slam/system/option_table.h"

#include "byre/base/nearest_name.h"
#include "byre/base/text_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <ranges>
#include <type_traits>

#include <fmt/format.h>

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
    return parse_whole<Number>(text);
  }
}

// A member of MethodOptions as an option.
struct Row {
  // Number within bounds, both inclusive.
  constexpr Row(const char* its_name, const char* its_unit, double lowest, double highest, const char* its_meaning)
      : name(its_name), unit(its_unit), low(lowest), high(highest), meaning(its_meaning) {}
  // Flag or choice.
  constexpr Row(const char* its_name, const char* its_meaning) : name(its_name), meaning(its_meaning) {}

  std::string_view name;
  const char* unit = "";
  double low = 0.0;
  double high = 0.0;
  const char* meaning;
};

std::string to_text(bool value) {
  return value ? "true" : "false";
}

std::string to_text(Pace pace) {
  return std::string(name_of(pace));
}

constexpr std::array kPaces = {Pace::same_thread, Pace::paced, Pace::live};

template <typename Value>
std::string range_of(const Row& row) {
  if constexpr (std::is_same_v<Value, bool>) {
    return "true|false";
  } else if constexpr (std::is_same_v<Value, Pace>) {
    return fmt::format("{}", fmt::join(kPaces | std::views::transform(name_of), "|"));
  } else {
    return "from " + in_full(row.low) + " to " + in_full(row.high);
  }
}

// Value of a text; empty for an invalid one.
template <typename Value>
std::optional<Value> value_of(const Row& row, std::string_view text) {
  if constexpr (std::is_same_v<Value, bool>) {
    return text == "true" || text == "false" ? std::optional(text == "true") : std::nullopt;
  } else if constexpr (std::is_same_v<Value, Pace>) {
    const auto pace = std::ranges::find(kPaces, text, name_of);
    return pace != kPaces.end() ? std::optional(*pace) : std::nullopt;
  } else {
    const auto value = from_text<Value>(text);
    const bool is_within = value && static_cast<double>(*value) >= row.low && static_cast<double>(*value) <= row.high;
    return is_within ? value : std::nullopt;
  }
}

// Functions visit_...: call visit(member of o, row) for each option of a group.

template <typename Options, typename Visit>
void visit_run(Options& o, const Visit& visit) {
  visit(o.pace, {"pace", "thread of mapping, and feeding rate of recordings"});
  visit(o.session.map_online, {"map_online", "online mapping; false: a mission tracks the offline map only"});
  visit(o.keep_pictures, {"map.pictures", "small grey pictures of keyframes in a map being made, up to 12 kB each"});
  visit(
      o.session.trajectory.max_poses,
      {"trajectory.max_poses", "poses", 0, 1e8,
       "maximum number of stored trajectory poses: the newer half is complete, older poses are thinned out evenly; 0: "
       "unlimited"});
  visit(
      o.frame_deadline_ms,
      {"frame.deadline_ms", "milliseconds", 0, 1e6,
       "wall time limit per frame; to meet it, tracking skips online points first, then the right image; 0: no limit"});
}

template <typename Options, typename Visit>
void visit_features(Options& o, const Visit& visit) {
  visit(o.extract.max_features, {"features.max_count", "corners", 1, 1e5, "maximum number of corners per frame"});
  visit(o.extract.fast_threshold, {"features.fast_threshold_grey", "grey values", 1, 255,
                                   "FAST threshold: contrast between a corner and its surroundings"});
  visit(o.extract.min_fast_threshold,
        {"features.min_fast_threshold_grey", "grey values", 1, 255,
         "FAST threshold in image cells with too few corners at features.fast_threshold_grey"});
  visit(o.extract.threads, {"features.threads", "threads", 1, 64,
                            "threads of feature extraction per frame; results do not depend on the number"});
  visit(o.extract.depth.max_depth, {"depth.max_m", "metres", 0.1, 1e3, "maximum depth used of a depth camera"});
  visit(o.extract.depth.misalignment,
        {"depth.misalignment_px", "pixels", 0, 100, "maximum misregistration between depth image and colour image"});
}

template <typename Options, typename Visit>
void visit_calibration(Options& o, const Visit& visit) {
  visit(o.self_calibrate, {"calibration.refine", "refinement of the given calibration by image measurements"});
  visit(o.self_calibration.prior_sigmas, {"calibration.prior_sigmas", "sigmas of a good calibration", 1e-3, 1e3,
                                          "assumed error of the given calibration, prior of the refinement"});
  visit(o.self_calibration.max_keyframes,
        {"calibration.max_keyframes", "keyframes", 6, 1e4,
         "maximum number of keyframes in the refinement; its time grows with the cube of the number"});
}

template <typename Options, typename Visit>
void visit_tracking(Options& o, const Visit& visit) {
  visit(o.session.min_initial_points,
        {"start.min_points", "points", 1, 1e5, "minimum number of stereo points of the first keyframe"});
  visit(o.session.local_keyframes, {"tracking.local_keyframes", "keyframes", 1, 1e4,
                                    "keyframes of each map whose points are searched in a frame"});
  visit(o.session.track.search_radius, {"tracking.search_radius_px", "pixels at octave 0", 0.5, 1e3,
                                        "radius of the first search around the predicted pixel"});
  visit(o.session.track.wide_radius, {"tracking.wide_radius_px", "pixels at octave 0", 0.5, 1e3,
                                      "radius of the second search, used if the first one finds too few points"});
  visit(o.session.track.min_inliers,
        {"tracking.min_inliers", "points", 4, 1e5, "minimum number of inliers of a tracked pose"});
  visit(o.session.min_kept_share, {"tracking.min_kept_share", "share of the last frame's inliers", 0, 1,
                                   "share of inliers below which relocalisation without prediction runs as well"});
  visit(o.session.track.offline_weight, {"tracking.offline_weight", "weight of an online point", 1e-3, 1e3,
                                         "weight of an observation of an offline point in tracking and mapping"});
}

template <typename Options, typename Visit>
void visit_keyframes(Options& o, const Visit& visit) {
  visit(o.session.keyframes.min_tracked_share,
        {"keyframes.min_tracked_share", "share of the reference keyframe's points", 0, 1,
         "share of tracked points below which a keyframe is created"});
  visit(o.session.keyframes.min_tracked, {"keyframes.min_tracked", "points", 0, 1e5,
                                          "number of tracked points below which a keyframe is created at once"});
  visit(o.session.keyframes.max_turn, {"keyframes.max_turn_rad", "radians", 0, 4,
                                       "rotation from the reference keyframe above which a keyframe is created"});
  visit(o.session.keyframes.max_shift_share,
        {"keyframes.max_shift_share", "share of the median depth", 0, 1e3,
         "translation from the reference keyframe above which a keyframe is created"});
  visit(o.session.keyframes.min_frames,
        {"keyframes.min_frames", "frames", 0, 1e4,
         "minimum number of frames between keyframes, unless tracking is about to fail"});
}

template <typename Options, typename Visit>
void visit_mapping(Options& o, const Visit& visit) {
  visit(o.session.window.movable,
        {"mapping.movable_keyframes", "keyframes", 1, 1e3, "online keyframes adjusted by one mapping job"});
  visit(o.session.window.anchors,
        {"mapping.anchor_keyframes", "keyframes", 0, 1e3, "neighbouring online keyframes held fixed in a mapping job"});
  visit(o.session.window.offline_anchors, {"mapping.offline_anchor_keyframes", "keyframes", 0, 1e3,
                                           "neighbouring offline keyframes held fixed in a mapping job"});
  visit(o.session.window.min_offline_sightings, {"mapping.min_offline_sightings", "sightings", 0, kMany,
                                                 "minimum number of offline point observations that fix the gauge"});
  visit(o.session.window.sightings_in_place_of_anchors,
        {"mapping.sightings_in_place_of_anchors", "sightings", 0, kMany,
         "number of offline point observations from which online anchors are left out"});
  visit(o.session.max_relative_depth_sigma, {"mapping.max_relative_depth_sigma", "share of the depth", 1e-6, 10,
                                             "maximum standard deviation of the depth of a new point"});
  visit(o.session.redundant_share,
        {"mapping.redundant_share", "share of a keyframe's points", 0, 1,
         "share of points that are offline or seen by three other keyframes, above which a keyframe is removed"});
}

template <typename Options, typename Visit>
void visit_localisation(Options& o, const Visit& visit) {
  visit(o.session.relocalise.min_inliers, {"localisation.min_inliers", "points", 4, kMany,
                                           "minimum number of inliers of a pose found without prediction"});
  visit(o.session.relocalise.min_spread, {"localisation.min_spread", "share of the image's diagonal", 0, 1,
                                          "minimum standard deviation of the inliers in their narrowest direction"});
  visit(o.session.relocalise.max_position_sigma,
        {"localisation.max_position_sigma", "share of the median depth", 0, 100,
         "maximum standard deviation of position of a pose found without prediction"});
  visit(o.session.relocalise.max_rotation_sigma,
        {"localisation.max_rotation_sigma_rad", "radians", 0, 10,
         "maximum standard deviation of rotation of a pose found without prediction"});
  visit(o.session.relocalise.seed, {"localisation.seed", "", 0, 1e15, "seed of the random samples of P3P RANSAC"});
}

template <typename Options, typename Visit>
void visit_loops(Options& o, const Visit& visit) {
  visit(o.close_loops,
        {"loops.close", "place recognition in the map being made, and its finishing; false: for comparison"});
  visit(o.session.loops.min_gap, {"loops.min_gap_keyframes", "keyframes", 1, kMany,
                                  "minimum number of keyframes between the newest keyframe and a loop candidate"});
  visit(o.session.loops.max_drift_share,
        {"loops.max_drift_share", "share of the path", 0, 10, "maximum drift that a loop corrects"});
  visit(o.session.loops.max_drift,
        {"loops.max_drift_m", "metres", 0, 1e3, "maximum drift that a loop corrects, added to loops.max_drift_share"});
  visit(o.session.loops.max_scale_drift,
        {"loops.max_scale_drift", "natural logarithm of the scale", 0, 10, "maximum scale drift of a monocular loop"});
  visit(o.session.loops.max_scale_sigma, {"loops.max_scale_sigma", "natural logarithm of the scale", 0, 10,
                                          "maximum standard deviation of the scale drift"});
  visit(o.session.loops.min_scale_points,
        {"loops.min_scale_points", "points", 1, kMany,
         "minimum number of points common to both ends of a loop for its scale drift"});
  visit(o.session.max_drift_to_fuse, {"loops.max_drift_to_fuse_px", "pixels", 0, 1e3,
                                      "drift up to which a loop only fuses points, without pose graph optimisation"});
}

template <typename Options, typename Visit>
void visit_mission(Options& o, const Visit& visit) {
  visit(o.session.mission.search_after,
        {"mission.search_after_m", "metres", 0, 1e3,
         "path without offline points after which places are searched in parallel to tracking"});
  visit(o.session.mission.restart_after,
        {"mission.restart_after_s", "seconds", 0, 1e5, "time without a pose after which a new online submap starts"});
  visit(o.session.state.lost_after, {"mission.lost_after_s", "seconds", 0, 1e5,
                                     "time without a confirmed pose after which a navigation error is reported"});
  visit(o.session.mission.registration.max_speed,
        {"mission.max_speed_m_per_s", "metres a second", 0, 100, "maximum speed of the robot"});
  visit(o.session.mission.registration.confirmations,
        {"mission.confirmations", "frames", 1, 1e3,
         "consistent frames required before mapping uses a place in the offline map"});
  visit(o.session.mission.registration.max_misses,
        {"mission.max_misses", "frames", 0, 1e3, "contradicting frames after which a place is dropped"});
  visit(o.session.mission.registration.accept_log_odds,
        {"mission.accept_log_odds", "nats", 0, 1e3,
         "log-odds of a place, over the map cells in view, from which it is accepted"});
  visit(o.session.mission.bounds.plane_margin,
        {"mission.plane_margin_m", "metres", 0, 1e3,
         "distance from the map's driving plane above which a place is rejected, in addition to its uncertainty"});
  visit(o.session.mission.bounds.plane_margin_tilt,
        {"mission.plane_margin_rad", "radians", 0, 4,
         "tilt against the map's driving plane above which a place is rejected, in addition to its uncertainty"});
  visit(o.session.mission.bounds.wall_margin,
        {"mission.wall_margin_m", "metres", 0, 1e3,
         "distance behind a wall of the floor plan above which a place is rejected, in addition to its uncertainty"});
  visit(o.session.mission.view.min_inliers,
        {"mission.min_offline_inliers", "points", 1, 1e5, "minimum number of offline inliers that constrain a pose"});
  visit(o.session.mission.view.min_expected, {"mission.min_offline_expected", "points", 1, 1e5,
                                              "number of offline points in view below which the robot is off the map"});
  visit(o.session.mission.view.min_features,
        {"mission.min_features", "corners", 0, 1e5, "number of corners below which the camera is blinded"});
  visit(o.session.mission.moved_points.frames,
        {"mission.frames_to_suspend", "frames", 1, 3e4,
         "excess of frames with an offline point at another place over frames with it in place, from which it is "
         "suspended"});
  visit(o.session.mission.moved_points.frames_to_return,
        {"mission.frames_to_return", "frames", 1, 3e4,
         "consecutive frames with a suspended point in its place after which it is used again"});
  visit(o.session.deferred_refinement.frames,
        {"mission.hindsight_frames", "frames", 0, kMany, "maximum number of frames refined in hindsight; 10 kB each"});
}

template <typename Options, typename Visit>
void visit_motion(Options& o, const Visit& visit) {
  visit(o.session.is_planar,
        {"motion.planar", "height, roll and pitch constrained to the driving plane of the offline map"});
  visit(o.use_saved_extrinsics,
        {"motion.known_mounting",
         "extrinsics of wheels and gyroscope initialised from the offline map, until measurements contradict them"});
  visit(
      o.motion_limits.max_speed,
      {"motion.max_speed_m_per_s", "metres a second", 0.01, 1e3,
       "maximum speed of the robot's base: faster wheel samples are dropped; if most are faster, wheels are ignored"});
  visit(o.motion_limits.max_turn_rate,
        {"motion.max_turn_rate_rad_per_s", "radians a second", 0.01, 1e3,
         "maximum turn rate of base and gyroscope: faster samples are dropped; if most are faster, the gyroscope is "
         "ignored"});
  visit(o.motion_limits.max_acceleration,
        {"motion.max_acceleration_m_per_s2", "m/s^2", 10, 1e4,
         "maximum acceleration measured by the accelerometer: larger samples are dropped"});
  visit(o.motion_limits.max_position, {"motion.max_position_m", "metres", 1, 1e9,
                                       "distance from the origin of wheel odometry beyond which a pose is dropped"});
  visit(o.wheel_scale_sigma,
        {"motion.wheel_scale_sigma", "share of the length", 0, 1,
         "standard deviation of the metric scale that wheels give a monocular map, added to that of the fit"});
}

template <typename Options, typename Visit>
void visit_health(Options& o, const Visit& visit) {
  visit(o.session.health.trusted_error,
        {"health.trusted_error_m", "metres", 1e-6, 1e3, "maximum position error of a trusted pose"});
  visit(o.session.health.sigmas,
        {"health.sigmas", "sigmas", 0, 100,
         "number of standard deviations of position that must be within health.trusted_error_m"});
  visit(o.session.health.drift_share, {"health.drift_share", "share of the path", 0, 1,
                                       "assumed drift since the last pose constrained by offline points"});
  visit(o.session.health.max_rotation_sigma, {"health.max_rotation_sigma_rad", "radians", 0, 10,
                                              "maximum standard deviation of rotation of a trusted pose"});
  visit(o.session.health.max_bridged_rotation, {"health.max_bridged_rotation_rad", "radians", 0, 10,
                                                "maximum rotation error of a degraded pose during dead reckoning"});
  visit(o.session.health.min_points,
        {"health.min_points", "points", 0, 1e5, "minimum number of inliers of both maps together of a trusted pose"});
  visit(o.session.health.min_spread, {"health.min_spread", "share of the image's diagonal", 0, 1,
                                      "minimum standard deviation of the inliers in their narrowest direction"});
  visit(o.session.health.max_disagreement,
        {"health.max_disagreement_m", "metres", 0, 1e3,
         "maximum distance between the pose by offline points and the pose by online points"});
  visit(o.session.health.min_offline_points,
        {"health.min_offline_points", "points", 0, 1e5,
         "minimum number of offline inliers of a trusted pose if many offline points are in view"});
  visit(o.session.health.max_changed_path,
        {"health.max_changed_path_m", "metres", 0, 1e5, "path with fewer offline inliers that is tolerated"});
  visit(o.session.health.max_frozen,
        {"health.max_frozen_s", "seconds", 0, 1e3, "time with an unchanged image from which poses are untrusted"});
}

template <typename Options, typename Visit>
void visit_image(Options& o, const Visit& visit) {
  visit(o.session.image.min_brightness,
        {"image.min_brightness_grey", "grey values", 0, 255, "brightness below which an image is dark"});
  visit(o.session.image.max_brightness,
        {"image.max_brightness_grey", "grey values", 0, 255, "brightness above which an image is overexposed"});
  visit(o.session.image.min_contrast,
        {"image.min_contrast_grey", "grey values", 0, 255, "contrast below which an image is low in contrast"});
  visit(o.session.image.min_sharpness,
        {"image.min_sharpness", "share of the contrast", 0, 10, "sharpness below which an image is blurred"});
}

template <typename Options, typename Visit>
void visit_options(Options&& o, const Visit& visit) {
  visit_run(o, visit);
  visit_features(o, visit);
  visit_calibration(o, visit);
  visit_tracking(o, visit);
  visit_keyframes(o, visit);
  visit_mapping(o, visit);
  visit_localisation(o, visit);
  visit_loops(o, visit);
  visit_mission(o, visit);
  visit_motion(o, visit);
  visit_health(o, visit);
  visit_image(o, visit);
}

std::string text_of(const MethodOptions& options, std::string_view name) {
  std::string text;
  visit_options(options, [&](const auto& member, const Row& row) {
    if (row.name == name) text = to_text(member);
  });
  return text;
}

bool set_by_name(MethodOptions& options, std::string_view name, std::string_view text) {
  bool is_set = false;
  visit_options(options, [&]<typename Value>(Value& member, const Row& row) {
    const auto value = row.name == name ? value_of<Value>(row, text) : std::nullopt;
    if (value) member = *value;
    is_set = is_set || value;
  });
  return is_set;
}

}  // namespace

const std::vector<MethodOption>& option_table() {
  static const std::vector<MethodOption> table = [] {
    std::vector<MethodOption> all;
    visit_options(MethodOptions{}, [&]<typename Value>(const Value&, const Row& row) {
      const std::string_view name = row.name;
      all.push_back(
          {std::string(name), row.unit, range_of<Value>(row), row.meaning,
           [name](const MethodOptions& options) { return text_of(options, name); },
           [name](MethodOptions& options, std::string_view text) { return set_by_name(options, name, text); }});
    });
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
  const std::vector<MethodOption>& table = option_table();
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
