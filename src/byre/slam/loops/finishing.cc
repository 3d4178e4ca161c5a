#include "byre/slam/loops/finishing.h"

#include "byre/slam/loops/recent_map.h"
#include "byre/slam/window/mapping_steps.h"
#include "byre/trajectory_error.h"

#include <algorithm>
#include <set>
#include <utility>

namespace byre {
namespace {

// Neighbours of a keyframe that must confirm its loop.
constexpr int kConfirmingKeyframes = 6;

bool stopped(const FinishHooks& hooks) {
  return hooks.should_stop && hooks.should_stop();
}

void announce(const FinishHooks& hooks, const char* step) {
  if (hooks.before_step) hooks.before_step(step);
}

// Tests a loop at the neighbours of its keyframe. The drift stays that of the keyframe.
LoopHypothesis tested_at_neighbours(const MapGraph& map, LoopHypothesis hypothesis) {
  for (const Covisible& neighbour : map.covisible_keyframes(hypothesis.keyframe, kConfirmingKeyframes)) {
    const Keyframe& keyframe = *map.find_keyframe(neighbour.keyframe);
    const LoopHypothesis tested =
        check_loop(hypothesis, keyframe.frame, keyframe.camera_from_world, rig_of(map, keyframe), map);
    hypothesis.test = tested.test;
    hypothesis.untracked = tested.untracked;
  }
  return hypothesis;
}

// The loops of keyframes, from the last keyframe backwards, tested at their neighbours, which are not searched again.
// find: for a keyframe and the loops so far. is_usable: result of the test.
template <typename Find, typename IsUsable>
std::vector<LoopHypothesis> tested_loops(const MapGraph& map, const std::vector<KeyframeId>& ids, Find find,
                                         IsUsable is_usable) {
  std::vector<LoopHypothesis> loops;
  std::set<KeyframeId> settled;
  for (auto id = ids.rbegin(); id != ids.rend(); ++id) {
    if (settled.contains(*id)) continue;
    const std::optional<LoopHypothesis> found = find(*id, loops);
    if (!found) continue;
    const LoopHypothesis tested = tested_at_neighbours(map, *found);
    if (!is_usable(tested)) continue;
    loops.push_back(tested);
    for (const Covisible& neighbour : map.covisible_keyframes(*id, kConfirmingKeyframes)) {
      settled.insert(neighbour.keyframe);
    }
  }
  return loops;
}

LengthChanges correct(MapGraph& online, const std::vector<LoopEdge>& edges, std::uint32_t first_new,
                      const FinishOptions& options, const FinishHooks& hooks) {
  MapWindow recent = recent_map(online, first_new, edges);
  add_motions(recent, options.motions);
  return adjust_at_once(std::move(recent), edges, options.global, online, hooks.should_stop);
}

// Corrects the map around new keyframes, then the whole map if a loop still disagrees. Returns the number of the first
// keyframe that counted as new in the last correction.
std::uint32_t correct_around(MapGraph& online, const std::vector<LoopEdge>& edges, const FinishOptions& options,
                             const FinishHooks& hooks, FinishReport& report) {
  report.length_changes = correct(online, edges, options.first_new, options, hooks);
  const auto disagrees = [&](const LoopEdge& edge) {
    return disagreement(online, in_new_lengths(edge, report.length_changes)) > kMaxLoopDisagreement;
  };
  if (options.first_new == 0 || stopped(hooks) || std::ranges::none_of(edges, disagrees)) return options.first_new;
  std::vector<LoopEdge> again;
  for (const LoopEdge& edge : edges) again.push_back(in_new_lengths(edge, report.length_changes));
  for (const auto& [id, growth] : correct(online, again, 0, options, hooks)) {
    const auto [change, is_new] = report.length_changes.try_emplace(id, growth);
    if (!is_new) change->second *= growth;
  }
  return 0;
}

void thin_out(MapGraph& online, std::uint32_t first_new, const FinishOptions& options) {
  MapWindow thinned = recent_map(online, first_new, {});
  if (thinned.keyframes.empty()) return;
  const KeyframeId newest = thinned.keyframes.back().id;
  remove_weak_points(thinned, newest);
  remove_redundant_keyframes(thinned, options.global.mapping);
  remove_weak_points(thinned, newest);
  const MapDelta delta = difference(online, thinned);
  thinned = {};
  apply(delta, online);
}

int count_parts(const MapGraph& map) {
  std::set<KeyframeId> seen;
  int parts = 0;
  for (const KeyframeId start : map.keyframe_ids()) {
    if (!seen.insert(start).second) continue;
    ++parts;
    std::vector<KeyframeId> reached = {start};
    while (!reached.empty()) {
      const KeyframeId id = reached.back();
      reached.pop_back();
      for (const Covisible& next : map.covisible_keyframes(id)) {
        if (seen.insert(next.keyframe).second) reached.push_back(next.keyframe);
      }
    }
  }
  return parts;
}

// Pixels, of every observation.
std::vector<double> reprojection_errors(const MapGraph& map) {
  std::vector<double> errors;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    for (const Sighting& sighting : keyframe.sightings) {
      const MapPoint* const point = sighting.point ? map.find_point(*sighting.point) : nullptr;
      if (point == nullptr) continue;
      const Eigen::Vector3d point_in_camera = keyframe.camera_from_world * point->position_in_world;
      if (point_in_camera.z() <= 0.0) continue;
      const Eigen::Vector2d predicted = rig_of(map, keyframe).project(point_in_camera).head<2>();
      errors.push_back((predicted - sighting.pixel.cast<double>()).norm());
    }
  }
  return errors;
}

}  // namespace

MapQuality quality_of(const MapGraph& map) {
  MapQuality quality{map.keyframe_count(), map.point_count(), 0, 0.0, 0.0, count_parts(map)};
  const ErrorStatistics errors = summarise(reprojection_errors(map));
  quality.observations = errors.count;
  quality.reprojection_median = errors.median;
  quality.reprojection_p95 = errors.p95;
  return quality;
}

std::vector<LoopHypothesis> search_loops(const MapGraph& map, const PlaceIndex& places, const FinishOptions& options,
                                         const FinishHooks& hooks) {
  std::vector<KeyframeId> ids = map.keyframe_ids();
  std::erase_if(ids, [&](KeyframeId id) { return id.number < options.first_new; });
  const auto find = [&](KeyframeId id, const auto&) {
    return stopped(hooks) ? std::nullopt : find_loop(map, places, id, options.loops);
  };
  return tested_loops(map, ids, find, is_confirmed);
}

std::vector<LoopHypothesis> search_joins(const MapGraph& map, const PlaceIndex& places,
                                         const std::vector<KeyframeId>& keyframes,
                                         const std::function<bool(KeyframeId)>& is_in_map, const LoopOptions& options) {
  constexpr int kMaxUntracked = kConfirmingKeyframes / 2;
  const auto find = [&](KeyframeId id, const std::vector<LoopHypothesis>& joins) {
    return find_join(map, places, id, is_in_map, joins.empty() ? nullptr : &joins.back(), options);
  };
  const auto is_tracked = [](const LoopHypothesis& join) { return join.untracked <= kMaxUntracked; };
  const std::vector<LoopHypothesis> joins = tested_loops(map, keyframes, find, is_tracked);
  if (joins.empty()) return {};
  // Two keyframes do not yield one similarity by chance, which outweighs the prior of the test.
  const bool is_repeated = joins.size() > 1;
  const double log_odds = joins.back().test.log_odds() - (is_repeated ? kLogOddsOfKidnapping : 0.0);
  if (log_odds < RegistrationOptions{}.accept_log_odds) return {};
  for (const LoopHypothesis& one : joins) {
    for (const LoopHypothesis& other : joins) {
      if (!agree(one, other, map, options)) return {};
    }
  }
  return joins;
}

FinishReport finish_map(MapGraph& online, const PlaceIndex& places, const FinishOptions& options,
                        const FinishHooks& hooks) {
  FinishReport report;
  report.before = quality_of(online);
  announce(hooks, "searching for loops");
  std::vector<LoopEdge> edges = options.joins;
  for (const LoopHypothesis& loop : search_loops(online, places, options, hooks)) {
    report.loop_drifts.push_back(apparent_drift(loop, online));
    edges.push_back(*edge_of(loop, online));
  }
  report.loops = static_cast<int>(edges.size());
  announce(hooks,
           options.first_new == 0 ? "adjusting the whole map" : "adjusting new keyframes and their surroundings");
  std::uint32_t first_new = options.first_new;
  if (!stopped(hooks)) first_new = correct_around(online, edges, options, hooks, report);
  announce(hooks, "removing redundant keyframes");
  if (!stopped(hooks)) thin_out(online, first_new, options);
  for (const LoopEdge& edge : edges) {
    report.loop_residuals.push_back(disagreement(online, in_new_lengths(edge, report.length_changes)));
  }
  report.after = quality_of(online);
  report.keyframes_removed = report.before.keyframes - report.after.keyframes;
  report.points_removed = report.before.points - report.after.points;
  return report;
}

}  // namespace byre
