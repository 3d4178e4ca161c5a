#pragma once

#include "byre/slam/tracking/measurement.h"
#include "byre/slam/window/mapping.h"

#include <functional>
#include <vector>

// Steps of extend_map on a window. Keyframes and points are indices into the window.
namespace byre {

inline constexpr int kOfflineNeighbours = 4;  // offline keyframes searched for new and for duplicate points

inline CameraView view_of(const MapWindow& window, int keyframe) {
  const WindowKeyframe& entry = window.keyframe(keyframe);
  return {*entry.keyframe.frame.features, window.rig_of(entry), entry.keyframe.camera_from_world};
}

// Measurement of a point by a feature of a window's keyframe: relative to the point's reference if that is in the
// window, by the corner alone otherwise.
Sighting measure_in_window(const MapWindow& window, int point, int keyframe, int feature);

// Observation of the window for bundle adjustment; pose, point and weight are left to the caller.
BundleObservation bundle_observation(const WindowKeyframe& keyframe, int feature);

// Triangulates new points between a keyframe and its nearest neighbours from features without a point: matched along
// the epipolar line, refined in the image, kept if the depth is precise and both views agree.
void triangulate_new_points(MapWindow& window, int keyframe, const MappingOptions& options);

// Matches points of the neighbours in the keyframe, and its points in the neighbours. A match at a free feature adds an
// observation. At a feature with another point, the points are fused into the one with more observations; an offline
// point always remains.
void fuse_duplicates(MapWindow& window, int keyframe, const MappingOptions& options);
// Same with these neighbours.
void fuse_between(MapWindow& window, int keyframe, const std::vector<int>& neighbours, const MappingOptions& options);

// Local bundle adjustment in two rounds, each followed by outlier removal. Offline points are fixed; their observations
// have a larger weight (see MappingOptions), limited by the covariances of the points. should_stop, unless empty, ends
// it early with the present result.
void adjust_bundle(MapWindow& window, const MappingOptions& options, const std::function<bool()>& should_stop = {});

// Same for the points alone. Precondition: no keyframe is movable.
void adjust_points(MapWindow& window, const MappingOptions& options);

// Covariances of an adjusted window's movable keyframes relative to the fixed ones, by observations and measured
// motion. Computed for a sample spread over the window; other keyframes get that of the nearest one in order.
void refresh_covariances(MapWindow& window, const MappingOptions& options);

// Updates position covariance, descriptor, viewing direction and distances of the window's points from their
// observations.
void refresh_points(MapWindow& window);

// Removes points that later keyframes should have confirmed and did not. newest: reference for the age of points.
// hidden: of the window's first keyframe; points behind dirt there are kept until they leave it.
void remove_weak_points(MapWindow& window, KeyframeId newest, const ImageMask& hidden = {});

// Removes keyframes nearly all of whose points are offline or seen by at least three other online keyframes.
void remove_redundant_keyframes(MapWindow& window, const MappingOptions& options);

}  // namespace byre
