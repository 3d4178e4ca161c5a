#pragma once

#include "byre/alignment.h"
#include "byre/map/map_graph.h"
#include "byre/place/place_index.h"
#include "byre/slam/places/localisation.h"
#include "byre/slam/places/place_hypothesis.h"
#include "byre/slam/tracking/tracking.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// Depths of one scene point in two parts of a map, both from one camera.
struct DepthPair {
  double newer = 0.0;
  double older = 0.0;
  double sigma = 0.0;  // standard deviation of the logarithm of their ratio
};

// Scale drift between two parts of a map.
struct ScaleDrift {
  double old_per_new = 1.0;  // length in the older part per length in the newer
  double sigma = 0.0;        // standard deviation of the logarithm of old_per_new
};

// Depth pairs of the features that see a point of the keyframe's own and a point of the older part.
std::vector<DepthPair> depth_pairs(const MapGraph& map, const Keyframe& keyframe, const TrackedFrame& in_older_part);

// Mean ratio of depths after outlier rejection by the distance from the median, relative to the spread. One camera
// measures directions better than lengths: its position is estimated from rays (localise), and only this scale is left.
// Empty with fewer than min_pairs inliers.
std::optional<ScaleDrift> estimate_scale_drift(std::span<const DepthPair> pairs, int min_pairs);

// A keyframe of the newer part of a map and one of the older part that see the same place, with their relative pose.
// With scale drift: point_in_keyframe = keyframe_from_place * (scale * point_in_place), each in the lengths of the map
// around it.
struct LoopEdge {
  KeyframeId keyframe;
  KeyframeId place;
  Pose keyframe_from_place;              // motion between both cameras
  Matrix6 covariance = Matrix6::Zero();  // covariance of delta in exp_pose(delta) * keyframe_from_place
  double scale = 1.0;                    // other than 1 only for a keyframe without stereo
  double scale_sigma = 0.0;              // standard deviation of the scale's logarithm
};

// Minimum number of frames between loops: until mapping has closed a loop, the next frames would find it again.
inline constexpr int kMinFramesBetweenLoops = 10;

struct LoopOptions {
  std::uint32_t min_gap = 20;     // keyframes between a place and the newest: nearer ones are reached by tracking
  double max_drift_share = 0.03;  // drift of the map, share of the path since the place was seen
  double max_drift = 0.3;         // metres of drift in addition to that share
  double max_scale_drift = 0.4;  // natural logarithm; the drift of positions may increase by the same share of the path
  double max_scale_sigma = 0.03;  // natural logarithm; a less precise loop would do harm
  int min_scale_points = 15;      // points seen in both parts of the map, from which the scale drift is estimated
};

// Loop candidate of the newest keyframe.
struct LoopHypothesis {
  KeyframeId keyframe;
  KeyframeId place;
  // Drift, as the transform from the newer to the older part of the map. point_in_old = old_from_new * (scale *
  // point_in_new), see drift_of.
  Pose old_from_new;
  // Covariance of the keyframe's camera in the older part, see TrackedFrame::match_covariance.
  Matrix6 covariance = Matrix6::Zero();
  double median_depth = 0.0;  // median depth of the first keyframe's points in the older part, its lengths
  double scale = 1.0;         // other than 1 only for a keyframe without stereo
  double scale_sigma = 0.0;   // standard deviation of the scale's logarithm
  // Test of the poses in the older part by expected points. Even prior: LoopOptions bound the drift, and within the
  // bounds any drift is equally likely.
  PlaceHypothesis test{0.0, 3};
  // Largest disagreement of a frame's poses in both parts: share of the median depth, and radians.
  double max_disagreement = 0.01;
  int untracked = 0;  // frames not tracked in the older part
};

inline Similarity drift_of(const LoopHypothesis& hypothesis) {
  return {hypothesis.scale, hypothesis.old_from_new};
}

// View of an online map from a pose in it. Monocular lengths are not metric, so they are scaled to a median depth of 5
// m. Stereo lengths are scaled likewise if the depth is less, since there would be too few cells.
PlaceView view_of_map(const Frame& frame, const TrackedFrame& tracked, double median_depth, const Rig& rig,
                      const MapGraph& map);

// Localises the newest keyframe at keyframes that share no points with its surroundings. Accepts only a drift within
// the bounds for the path: a fence repeats within metres, but a map does not drift by metres within a few. Without
// stereo the scale drift is estimated from points that the keyframe sees in both parts.
std::optional<LoopHypothesis> find_loop(const MapGraph& map, const PlaceIndex& index, KeyframeId newest,
                                        const LoopOptions& options);

// Same for a keyframe whose words, one per feature, are not in map and index yet.
std::optional<LoopHypothesis> find_loop_by_words(const MapGraph& map, const PlaceIndex& index, KeyframeId newest,
                                                 std::span<const Word> words, const LoopOptions& options);

// Localises a keyframe of a separate submap at keyframes of the map. Drift is the similarity between both, whatever its
// size; the test is stricter than that of a loop, since no bound on the drift excludes places that look alike. known:
// join of the same submap whose test continues, so that evidence of several places adds up; nullptr: none.
std::optional<LoopHypothesis> find_join(const MapGraph& map, const PlaceIndex& index, KeyframeId separate,
                                        const std::function<bool(KeyframeId)>& is_in_map, const LoopHypothesis* known,
                                        const LoopOptions& options);

// Whether two joins of a submap agree up to its drift between their keyframes.
bool agree(const LoopHypothesis& one, const LoopHypothesis& other, const MapGraph& map, const LoopOptions& options);

// Tracks a frame that has a pose in the newer part of the map in the older part too. Returns the hypothesis with this
// frame in its test, and with the drift by this frame if it was tracked.
LoopHypothesis check_loop(const LoopHypothesis& hypothesis, const Frame& frame, const Pose& camera_from_world,
                          const Rig& rig, const MapGraph& map);

inline bool is_confirmed(const LoopHypothesis& hypothesis) {
  return hypothesis.test.is_accepted();
}
bool is_refuted(const LoopHypothesis& hypothesis);  // rejected by the test, or no longer tracked

// The loop as an edge between two keyframes; empty if one of them was removed.
std::optional<LoopEdge> edge_of(const LoopHypothesis& hypothesis, const MapGraph& map);

// Image motion that the drift causes for the keyframe, scale drift included, pixels. Below the search radius of points,
// fusing them is enough.
double apparent_drift(const LoopHypothesis& hypothesis, const MapGraph& map);

}  // namespace byre
