#pragma once

#include "byre/alignment.h"
#include "byre/map/map_file.h"

#include <functional>

namespace byre {

// Calibration with a scaled baseline; images and disparities are the same. The measured camera pose on the body is not
// scaled. A monocular calibration is unchanged.
Calibration scaled(const Calibration& calibration, double factor);

// The map with scaled camera poses, see scaled_copy of a MapGraph. Its registration on a floor plan is adapted.
// Recordings keep their given calibrations, which identify the cameras; their refined ones get the scaled baseline.
StoredMap scaled_copy(const StoredMap& stored, double factor);

// Scales all lengths of a map, also of removed keyframes. Rigs are unchanged. Precondition: a positive factor.
void rescale(MapGraph& map, double factor);

// Moves a part of a map: its keyframes, removed ones included, and the points of which they are the reference.
// Precondition: an ancestor outside of the part has not been removed since the part was added.
void move_part(MapGraph& map, const Similarity& after_from_before, const std::function<bool(KeyframeId)>& is_moved);

// Point of a map whose contents move.
MapPoint moved(MapPoint point, const Pose& target_from_world);

// The map in another frame: poses, points and covariances, with lengths scaled by scaled_copy, and the registration on
// a floor plan. Preconditions: ids without gaps, and a positive scale.
StoredMap transformed_copy(const StoredMap& stored, const Similarity& target_from_map);

// Ratio of the map's baseline to the given one of a stereo recording: 1 unless its scale was corrected. Also 1 for a
// monocular recording and one without keyframes. Precondition: the recording exists.
double baseline_factor(const StoredMap& stored, std::size_t recording);

}  // namespace byre
