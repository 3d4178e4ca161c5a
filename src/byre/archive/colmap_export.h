#pragma once

#include "byre/dataset/colmap_model.h"
#include "byre/map/map_file.h"
#include "byre/recording.h"

#include <filesystem>
#include <map>
#include <string>

namespace byre {

using ImageNames = std::map<Timestamp, std::string>;  // by time

// The map as a model of the recordings' own left images, before rectification: cameras with their lenses, poses of
// these cameras, key points moved to where those images show them. Positions are those of the map. Point n has the id n
// + 1 in the model, and so has image n. Points that one keyframe alone sees, by its disparity, are left out: COLMAP's
// programs rely on two views. Images without a name among these are called "<time in nanoseconds>.png".
ColmapModel colmap_model_of(const StoredMap& stored, const ImageNames& names);

// How a recording names its images, of the left camera or of the right one if that is taken alone. Throws InputError as
// open_recording does, and for a video, which has no image files.
ImageNames names_of_images(const std::filesystem::path& recording, const OpenOptions& options = {});

}  // namespace byre
