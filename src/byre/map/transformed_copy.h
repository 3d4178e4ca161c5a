#pragma once

#include "byre/alignment.h"
#include "byre/map/map_file.h"

namespace byre {

// Point of a map whose contents move.
MapPoint moved(MapPoint point, const Pose& target_from_world);

// The map in another frame: poses, points and covariances, with lengths scaled by scaled_copy, and the registration on
// a floor plan. Preconditions: ids without gaps, and a positive scale.
StoredMap transformed_copy(const StoredMap& stored, const Similarity& target_from_map);

}  // namespace byre
