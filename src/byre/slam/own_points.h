#pragma once

#include "byre/slam/map_from_model.h"

namespace byre {

// Adds points for corners that are none of the model's points, triangulated from the model's poses. Where one of them
// turns out to be a point of the model, that one gets the views instead, as far as they show it where it is.
void add_own_points(const SfmModel& model, const ModelMapOptions& options, Map& map);

}  // namespace byre
