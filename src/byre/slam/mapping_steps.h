#pragma once

#include "byre/slam/mapping.h"
#include "byre/slam/measurement.h"

#include <functional>
#include <vector>

// The steps of extend_map, each on a window. Keyframes and points are named by their index in the window.
namespace byre {

inline constexpr int kOfflineNeighbours = 4;  // offline keyframes searched for new points, and for points seen twice

inline CameraView view_of(const MapWindow& window, int keyframe) {
  const WindowKeyframe& entry = window.keyframes[static_cast<std::size_t>(keyframe)];
  return {*entry.keyframe.frame.features, window.rig_of(entry), entry.keyframe.camera_from_world};
}

// The measurement of a point by a feature of a window's keyframe, against the point's reference where it is in the
// window; by the corner alone where it is not.
Sighting measure_in_window(const MapWindow& window, int point, int keyframe, int feature);

// Observation of the window as bundle adjustment takes it; pose, point and weight are left to the caller.
BundleObservation bundle_observation(const WindowKeyframe& keyframe, int feature);

// New points between a keyframe and its nearest neighbours from features that see none yet: matched along the epipolar
// line, triangulated, refined in the image, kept when the depth is known well enough and both views agree.
void triangulate_new_points(MapWindow& window, int keyframe, const MappingOptions& options);

// Points of the neighbours looked for in the keyframe and its points in the neighbours: found at a free feature they
// are observed once more, found at another point the one with fewer observations gives way, and an online one to an
// offline one.
void fuse_duplicates(MapWindow& window, int keyframe, const MappingOptions& options);
// The same with these neighbours.
void fuse_between(MapWindow& window, int keyframe, const std::vector<int>& neighbours, const MappingOptions& options);

// Local bundle adjustment in two rounds, with observations that disagree removed after each. Offline points stay where
// they are, and what sees them counts for more (see MappingOptions) but is trusted no further than their covariances.
// should_stop, unless empty, ends it early with what was reached.
void adjust_bundle(MapWindow& window, const MappingOptions& options, const std::function<bool()>& should_stop = {});

// The same for the points alone. Precondition: no keyframe is movable.
void adjust_points(MapWindow& window, const MappingOptions& options);

// Covariances of an adjusted window's movable keyframes, relative to those that are not, as all that is seen and told
// leaves them open. They are found for some, spread over the window; the others have that of the one nearest in order.
void refresh_covariances(MapWindow& window, const MappingOptions& options);

// Position covariance, descriptor, viewing direction and distances of the window's points, from their observations.
void refresh_points(MapWindow& window);

// Points that keyframes made since should have confirmed and did not; newest: the keyframe by which age is told.
// hidden: of the window's first keyframe; what lies behind dirt there waits until it comes out.
void remove_weak_points(MapWindow& window, KeyframeId newest, const HiddenCells& hidden = {});

// Keyframes that add nothing: nearly all of their points are offline, or seen by three other online keyframes at least.
void remove_redundant_keyframes(MapWindow& window, const MappingOptions& options);

}  // namespace byre
