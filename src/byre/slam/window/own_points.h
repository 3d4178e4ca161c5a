#pragma once

#include "byre/slam/window/map_from_model.h"

namespace byre {

// Adds points for corners that show no point of the model, triangulated from the model's poses. If such a point turns
// out to be a point of the model, that point gets the views that measure it at its position.
void add_own_points(const SfmModel& model, const ModelMapOptions& options, Map& map);

}  // namespace byre
