#include "byre/slam/loops/global_mapping.h"

#include "byre/alignment.h"
#include "byre/geometry/median.h"
#include "byre/optimise/pose_graph.h"
#include "byre/slam/loops/odometry_motions.h"
#include "byre/slam/tracking/body_pose.h"
#include "byre/slam/window/mapping_steps.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

namespace byre {
namespace {

// The parts of the window's keyframes, each named by one of its keyframes.
class Parts {
 public:
  explicit Parts(const MapWindow& window) : parent_(window.keyframes.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (const WindowPoint& point : window.points) {
      if (point.removed || point.observations.empty()) continue;
      for (const WindowObservation& seen : point.observations) join(seen.keyframe, point.observations.front().keyframe);
    }
    for (int& parent : parent_) parent = part_of(parent);
  }

  int part_of(int keyframe) const {
    while (parent_[static_cast<std::size_t>(keyframe)] != keyframe) {
      keyframe = parent_[static_cast<std::size_t>(keyframe)];
    }
    return keyframe;
  }

 private:
  void join(int first, int second) {
    const auto [low, high] = std::minmax({part_of(first), part_of(second)});
    parent_[static_cast<std::size_t>(high)] = low;
  }

  std::vector<int> parent_;
};

Pose world_from_body(const MapWindow& window, int keyframe) {
  const WindowKeyframe& entry = window.keyframe(keyframe);
  return body_pose(window.rig_of(entry), entry.keyframe.camera_from_world);
}

// Scale of each monocular part relative to measured motion; missing with too few motions.
std::map<int, double> lengths_of_parts(const MapWindow& window, const Parts& parts) {
  constexpr int kFew = 3;
  std::map<int, LengthRatio> ratios;
  for (const WindowMotion& motion : window.motions) {
    const int part = parts.part_of(motion.earlier);
    const WindowKeyframe& earlier = window.keyframe(motion.earlier);
    if (part != parts.part_of(motion.later) || window.rig_of(earlier).is_stereo()) continue;
    ratios[part].add(motion.motion,
                     inverse(world_from_body(window, motion.earlier)) * world_from_body(window, motion.later));
  }
  std::map<int, double> lengths;
  for (const auto& [part, ratio] : ratios) {
    if (ratio.count() >= kFew && ratio.value()) lengths[part] = *ratio.value();
  }
  return lengths;
}

void move_part(MapWindow& window, const Parts& parts, int part, const Similarity& after_from_before) {
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    if (parts.part_of(static_cast<int>(i)) != part) continue;
    Pose& pose = window.keyframes[i].keyframe.camera_from_world;
    pose = move_camera(after_from_before, pose);
  }
  const auto scale = static_cast<float>(after_from_before.scale);
  for (WindowPoint& point : window.points) {
    if (point.removed || point.observations.empty()) continue;
    if (parts.part_of(point.observations.front().keyframe) != part) continue;
    point.point.position_in_world = after_from_before * point.point.position_in_world;
    point.point.min_distance *= scale;
    point.point.max_distance *= scale;
  }
}

// Moves the part of the later keyframe to the pose predicted from the earlier one, with lengths scaled by growth.
Similarity placement(const MapWindow& window, const WindowMotion& motion, double growth) {
  const Pose before = world_from_body(window, motion.later);
  return {growth, world_from_body(window, motion.earlier) * motion.motion.last_from_body *
                      inverse(scale_lengths(before, growth))};
}

constexpr int kMinSharedPoints = 50;        // points shared by keyframes that the pose graph joins
constexpr int kMaxNeighbours = 10;          // neighbours of a keyframe in the pose graph
constexpr int kFusionNeighbours = 10;       // keyframes on each side of a loop whose points are fused
constexpr int kSecondBundleIterations = 6;  // iterations after outlier removal

constexpr int kMinOfflineSightings = 30;  // offline points that constrain a keyframe, or a whole map

using IndexOfKeyframe = std::map<KeyframeId, int>;

IndexOfKeyframe index_keyframes(const MapWindow& window) {
  IndexOfKeyframe index;
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) index[window.keyframes[i].id] = static_cast<int>(i);
  return index;
}

Pose& pose_of(MapWindow& window, int keyframe) {
  return window.keyframe(keyframe).keyframe.camera_from_world;
}
const Pose& pose_of(const MapWindow& window, int keyframe) {
  return window.keyframe(keyframe).keyframe.camera_from_world;
}

// Points shared with each other keyframe, by its index.
std::map<int, int> count_shared_points(const MapWindow& window, int keyframe) {
  std::map<int, int> shared;
  for (const int point : window.keyframe(keyframe).point_of_feature) {
    if (point < 0) continue;
    for (const WindowObservation& seen : window.point(point).observations) {
      if (seen.keyframe != keyframe) ++shared[seen.keyframe];
    }
  }
  return shared;
}

// The keyframes that share most points with this one, most first.
std::vector<std::pair<int, int>> nearest_keyframes(const MapWindow& window, int keyframe, int min_shared, int count) {
  std::vector<std::pair<int, int>> ranked;  // shared points, index
  for (const auto& [other, shared] : count_shared_points(window, keyframe)) {
    if (shared >= min_shared) ranked.emplace_back(shared, other);
  }
  std::ranges::sort(ranked, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  if (static_cast<int>(ranked.size()) > count) ranked.resize(static_cast<std::size_t>(count));
  return ranked;
}

// Equivalent of a metre in a map without stereo, whose unit of length is arbitrary: a share of the depth.
double length_of_a_metre(const MapWindow& window) {
  constexpr double kUsualDepth = 3.0;  // metres
  if (!scale_may_drift(window)) return 1.0;
  std::vector<double> depths;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    for (const int point : keyframe.point_of_feature) {
      if (point < 0) continue;
      const Eigen::Vector3d& position = window.point(point).point.position_in_world;
      depths.push_back((keyframe.keyframe.camera_from_world * position).z());
    }
  }
  return depths.empty() ? 1.0 : median(std::move(depths)) / kUsualDepth;
}

// Relative precision of two covisible keyframes that share 100 points. Only the proportions matter.
constexpr double kPositionSigma = 0.003;  // metres
constexpr double kRotationSigma = 0.001;  // radians
constexpr double kScaleSigma = 0.003;     // natural logarithm of the scale

Matrix6 covisible_information(int shared_points, double metre) {
  const double position_sigma = kPositionSigma * metre;
  Vector6 weights;
  weights << Eigen::Vector3d::Constant(1.0 / (position_sigma * position_sigma)),
      Eigen::Vector3d::Constant(1.0 / (kRotationSigma * kRotationSigma));
  return Matrix6((weights * (shared_points / 100.0)).asDiagonal());
}

// Edge of a loop, weighted like `links` edges. Its covariance is that of its matches plus that of neighbours, since
// errors of points are correlated.
PoseGraphEdge graph_edge(const LoopEdge& loop, int place, int keyframe, double metre, double links) {
  return {.first = place,
          .second = keyframe,
          .second_from_first = loop.keyframe_from_place,
          .information = links * (loop.covariance + covisible_information(100, metre).inverse()).inverse(),
          .scale = loop.scale,
          .scale_sigma = std::hypot(loop.scale_sigma, kScaleSigma) / std::sqrt(links)};
}

PoseGraphEdge edge_between(const MapWindow& window, int first, int second, int shared_points, double metre) {
  return {.first = first,
          .second = second,
          .second_from_first = pose_of(window, second) * inverse(pose_of(window, first)),
          .information = covisible_information(shared_points, metre),
          .scale_sigma = kScaleSigma * std::sqrt(100.0 / shared_points)};
}

// Loops bend the map out of view of the offline map; keyframes in view of it are fixed.
bool is_held(const MapWindow& window, const WindowKeyframe& keyframe) {
  return !keyframe.movable || count_offline_sightings(window, keyframe) >= kMinOfflineSightings;
}

PoseGraphNode node_of(const MapWindow& window, const WindowKeyframe& keyframe) {
  return {.camera_from_world = keyframe.keyframe.camera_from_world,
          .fixed = is_held(window, keyframe),
          .scale_is_known = window.rig_of(keyframe).is_stereo()};
}

PoseGraphEdge edge_of_motion(const MapWindow& window, const WindowMotion& motion) {
  const Rig& earlier = window.rig_of(window.keyframe(motion.earlier));
  const Rig& later = window.rig_of(window.keyframe(motion.later));
  const Matrix6 covariance = move_covariance(motion.motion.covariance, inverse(later.body_from_camera));
  return {.first = motion.earlier,
          .second = motion.later,
          .second_from_first =
              inverse(later.body_from_camera) * inverse(motion.motion.last_from_body) * earlier.body_from_camera,
          .information = covariance.inverse(),
          .is_in_world_lengths = true};
}

PoseGraph make_pose_graph(const MapWindow& window, const IndexOfKeyframe& index_of,
                          const std::vector<LoopEdge>& loops) {
  PoseGraph graph;
  const double metre = length_of_a_metre(window);
  // A drift of scale opens gaps wider than the search radius of fusion, so a loop counts as links between all keyframes
  // whose points are fused.
  const double links = scale_may_drift(window) ? std::pow(kFusionNeighbours, 2) : 1.0;
  std::set<std::pair<int, int>> joined;
  const auto join = [&](int first, int second, int shared) {
    if (!joined.insert(std::minmax(first, second)).second) return;
    graph.edges.push_back(edge_between(window, first, second, shared, metre));
  };
  for (const WindowMotion& motion : window.motions) {
    graph.edges.push_back(edge_of_motion(window, motion));
    const bool is_seen = count_shared_points(window, motion.later).contains(motion.earlier);
    if (!is_seen) joined.insert(std::minmax(motion.earlier, motion.later));
  }
  for (int i = 0; i < static_cast<int>(window.keyframes.size()); ++i) {
    const WindowKeyframe& keyframe = window.keyframe(i);
    graph.nodes.push_back(node_of(window, keyframe));
    for (const auto& [shared, other] : nearest_keyframes(window, i, kMinSharedPoints, kMaxNeighbours)) {
      join(other, i, shared);
    }
    const auto parent = keyframe.keyframe.parent ? index_of.find(*keyframe.keyframe.parent) : index_of.end();
    if (parent != index_of.end()) join(parent->second, i, kMinSharedPoints);
  }
  // Fixed keyframes around new ones have the scale of the map, and keep it; the first keyframe of a whole map has none.
  if (std::ranges::count(graph.nodes, true, &PoseGraphNode::fixed) > 1) {
    for (PoseGraphNode& node : graph.nodes) node.scale_is_known = node.scale_is_known || node.fixed;
  }
  for (const LoopEdge& loop : loops) {
    const auto place = index_of.find(loop.place), keyframe = index_of.find(loop.keyframe);
    if (place == index_of.end() || keyframe == index_of.end()) continue;
    graph.edges.push_back(graph_edge(loop, place->second, keyframe->second, metre, links));
  }
  return graph;
}

// Scales the distance of a point from the camera.
void grow(MapPoint& point, double growth, const Pose& camera_from_world) {
  const Eigen::Vector3d camera_in_world = inverse(camera_from_world).translation;
  point.position_in_world = camera_in_world + growth * (point.position_in_world - camera_in_world);
  point.min_distance *= static_cast<float>(growth);
  point.max_distance *= static_cast<float>(growth);
}

// Moves the keyframes, and each point with its reference keyframe, in the scale of that keyframe.
void write_back(MapWindow& window, const IndexOfKeyframe& index_of, const PoseGraphResult& optimised) {
  for (WindowPoint& point : window.points) {
    const auto reference = index_of.find(point.point.reference.keyframe);
    if (point.removed || reference == index_of.end()) continue;
    const Pose& before = pose_of(window, reference->second);
    const Pose& after = optimised.camera_from_world[static_cast<std::size_t>(reference->second)];
    const double scale = optimised.scales[static_cast<std::size_t>(reference->second)];
    if (scale != 1.0) grow(point.point, 1.0 / scale, before);
    point.point.position_in_world = inverse(after) * (before * point.point.position_in_world);
  }
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    pose_of(window, static_cast<int>(i)) = optimised.camera_from_world[i];
  }
}

// A keyframe and those nearest to it.
std::vector<int> surroundings_of(const MapWindow& window, int keyframe, int count) {
  std::vector<int> surroundings = {keyframe};
  for (const auto& [shared, other] : nearest_keyframes(window, keyframe, 1, count - 1)) surroundings.push_back(other);
  return surroundings;
}

void fuse_around(MapWindow& window, int keyframe, int place, const MappingOptions& options) {
  const std::vector<int> newer = surroundings_of(window, keyframe, kFusionNeighbours);
  std::vector<int> older = surroundings_of(window, place, kFusionNeighbours);
  std::erase_if(older, [&](int index) { return std::ranges::find(newer, index) != newer.end(); });
  for (const int index : newer) fuse_between(window, index, older, options);
}

void close_loops(MapWindow& window, const std::vector<LoopEdge>& loops, const MappingOptions& options) {
  const IndexOfKeyframe index_of = index_keyframes(window);
  PoseGraphOptions graph_options;
  graph_options.scale_is_free = scale_may_drift(window);
  if (graph_options.scale_is_free) graph_options.is_robust = false;  // gaps of many sigmas are expected
  const PoseGraphResult optimised = optimise_pose_graph(make_pose_graph(window, index_of, loops), graph_options);
  if (optimised.usable) write_back(window, index_of, optimised);
  for (const LoopEdge& loop : loops) {
    const auto place = index_of.find(loop.place), keyframe = index_of.find(loop.keyframe);
    if (place == index_of.end() || keyframe == index_of.end()) continue;
    fuse_around(window, keyframe->second, place->second, options);
  }
}

// Places parts by all measured motions between them, such as a loop from the last to the first, and limits the drift of
// scale by these motions. Bundle adjustment would converge slowly, since the images hardly constrain either.
void optimise_with_motions(MapWindow& window) {
  const IndexOfKeyframe index_of = index_keyframes(window);
  PoseGraphOptions options;
  options.scale_is_free = scale_may_drift(window);
  const PoseGraphResult settled = optimise_pose_graph(make_pose_graph(window, index_of, {}), options);
  if (settled.usable) write_back(window, index_of, settled);
}

// Motion that fits points, without those that disagree: a point with few views may have moved by many metres.
Similarity align_most(std::vector<Eigen::Vector3d> from, std::vector<Eigen::Vector3d> to, Scale scale) {
  constexpr int kRounds = 5;
  constexpr double kDisagrees = 10.0;  // times the median error
  Similarity fit = align(from, to, scale).value_or(Similarity{});
  for (int round = 0; round < kRounds && !from.empty(); ++round) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < from.size(); ++i) errors.push_back((fit * from[i] - to[i]).norm());
    const double limit = kDisagrees * median(errors);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (errors[i] > limit) continue;
      from[kept] = from[i];
      to[kept++] = to[i];
    }
    if (kept == from.size()) break;
    from.resize(kept);
    to.resize(kept);
    fit = align(from, to, scale).value_or(fit);
  }
  return fit;
}

// Motion of an adjusted copy of both maps that fits its offline points to their earlier positions; the more precise
// half of them, as distant points move freely. Images of one camera do not determine the scale.
Similarity offline_from_adjusted(const MapWindow& adjusted, const MapWindow& before) {
  const auto sees_depth = [&](const WindowKeyframe& entry) {
    return is_offline(entry) && adjusted.rig_of(entry).is_stereo();
  };
  std::vector<double> variances;
  for (const WindowPoint& point : before.points) {
    if (is_offline(point)) variances.push_back(point.point.covariance.trace());
  }
  if (variances.empty()) return {};
  const double usual = median(std::move(variances));
  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t i = 0; i < before.points.size(); ++i) {
    const WindowPoint& point = before.points[i];
    if (!is_offline(point) || point.point.covariance.trace() > usual) continue;
    from.push_back(adjusted.points[i].point.position_in_world);
    to.push_back(point.point.position_in_world);
  }
  const bool is_scale_known = std::ranges::any_of(adjusted.keyframes, sees_depth);
  return align_most(std::move(from), std::move(to), is_scale_known ? Scale::fixed : Scale::free);
}

}  // namespace

bool scale_may_drift(const MapWindow& window) {
  const auto has_no_stereo = [&](const WindowKeyframe& keyframe) { return !window.rig_of(keyframe).is_stereo(); };
  const auto is_of_offline_map = [](const auto& entry) { return is_offline(entry); };
  return std::ranges::any_of(window.keyframes, has_no_stereo) &&
         std::ranges::none_of(window.motions, &WindowMotion::holds_scale) &&
         std::ranges::none_of(window.keyframes, is_of_offline_map) &&
         std::ranges::none_of(window.points, is_of_offline_map);
}

MapWindow whole_map(const MapView& map) {
  MapWindow window = window_of(map, map.online().keyframe_ids());
  for (WindowKeyframe& keyframe : window.keyframes) keyframe.movable = true;
  fix_gauge(window, kMinOfflineSightings);
  return window;
}

MapWindow both_maps(const MapView& map) {
  MapWindow online = whole_map(map);
  if (!std::ranges::all_of(online.keyframes, &WindowKeyframe::movable))
    return online;  // the offline map is hardly seen
  online = {};      // its memory is needed
  return window_of_both_maps(map);
}

AdjustedOffline detach_offline(MapWindow& adjusted, MapWindow& before) {
  const auto first = std::ranges::find_if(adjusted.keyframes, [](const auto& entry) { return is_offline(entry); });
  if (first == adjusted.keyframes.end()) return {};
  const auto online_count = static_cast<std::size_t>(first - adjusted.keyframes.begin());
  const auto is_detached = [&](const WindowObservation& seen) {
    return static_cast<std::size_t>(seen.keyframe) >= online_count;
  };
  const Similarity held = offline_from_adjusted(adjusted, before);
  AdjustedOffline offline;
  for (WindowKeyframe& entry : adjusted.keyframes) {
    Pose& pose = entry.keyframe.camera_from_world;
    pose = move_camera(held, pose);
    if (is_offline(entry)) offline.camera_from_world[entry.id] = pose;
  }
  for (WindowPoint& point : adjusted.points) {
    Eigen::Vector3d& position = point.point.position_in_world;
    position = held * position;
    if (is_offline(point)) offline.points_in_world[*point.id] = position;
    std::erase_if(point.observations, is_detached);
  }
  adjusted.keyframes.resize(online_count);
  before.keyframes.resize(online_count);
  return offline;
}

MapDelta adjust_map(MapWindow&& window, const MapWindow& before, const std::vector<LoopEdge>& loops,
                    const GlobalMappingOptions& options, const std::function<bool()>& should_stop) {
  MapWindow adjusted = std::move(window);
  adjust_window(adjusted, loops, options, should_stop);
  return difference(before, adjusted);
}

void adjust_window(MapWindow& window, const std::vector<LoopEdge>& loops, const GlobalMappingOptions& options,
                   const std::function<bool()>& should_stop) {
  const bool has_parts = place_parts(window);
  const bool may_drift = scale_may_drift(window);
  if (has_parts || (may_drift && !window.motions.empty())) optimise_with_motions(window);
  if (!loops.empty()) close_loops(window, loops, options.mapping);
  MappingOptions mapping = options.mapping;
  mapping.first_bundle_iterations = options.first_bundle_iterations;
  mapping.second_bundle_iterations = kSecondBundleIterations;
  adjust_bundle(window, mapping, should_stop);
  if (may_drift) refresh_covariances(window, mapping);
  refresh_points(window);
}

bool place_parts(MapWindow& window) {
  if (window.motions.empty()) return false;
  const Parts parts(window);
  if (std::ranges::none_of(window.motions, [&](const WindowMotion& motion) {
        return parts.part_of(motion.earlier) != parts.part_of(motion.later);
      })) {
    return false;
  }
  std::vector<bool> is_placed(window.keyframes.size(), false);  // by part
  const auto note_placed = [&](int keyframe) { is_placed[static_cast<std::size_t>(parts.part_of(keyframe))] = true; };
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    if (!window.keyframes[i].movable) note_placed(static_cast<int>(i));
  }
  const std::map<int, double> lengths = lengths_of_parts(window, parts);
  const auto length_of = [&](int part, double otherwise) {
    const auto found = lengths.find(part);
    return found == lengths.end() ? otherwise : found->second;
  };
  const auto time_of = [&](const WindowMotion& motion) { return window.keyframe(motion.later).keyframe.frame.time; };
  std::ranges::sort(window.motions, {}, time_of);
  const int first = window.motions.front().earlier;
  const double first_length = length_of(parts.part_of(first), 1.0);
  note_placed(first);
  for (WindowMotion& motion : window.motions) motion.motion = scale_motion(motion.motion, first_length);
  for (const WindowMotion& motion : window.motions) {
    const int before = parts.part_of(motion.earlier), part = parts.part_of(motion.later);
    if (is_placed[static_cast<std::size_t>(part)] || !is_placed[static_cast<std::size_t>(before)]) continue;
    move_part(window, parts, part, placement(window, motion, first_length / length_of(part, first_length)));
    note_placed(part);
  }
  return true;
}

}  // namespace byre
