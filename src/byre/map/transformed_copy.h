#pragma once

#include "byre/alignment.h"
#include "byre/map/map_file.h"

namespace byre {

// The map in another frame: poses, points and covariances, with lengths scaled by scaled_copy, and the registration on
// a floor plan. Preconditions: ids without gaps, and a positive scale.
StoredMap transformed_copy(const StoredMap& stored, const Similarity& target_from_map);

}  // namespace byre
