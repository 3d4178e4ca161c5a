#pragma once

#include "byre/extrinsics.h"
#include "byre/map/map_file.h"

#include <string>

namespace byre::cli {

// Extrinsics that drives with wheel odometry estimated, from the notes of the map. The height of the camera above the
// base is unobservable and that of the note. The scale of the wheels stays unknown if the map's lengths are theirs.
// place: name of the map. Throws InputError for a map without calibrated wheels.
Extrinsics extrinsics_of(const StoredMap& stored, const std::string& place);

}  // namespace byre::cli
