#pragma once

#include "byre/io/colmap/colmap_model.h"
#include "byre/map/map_file.h"
#include "byre/recording.h"

#include <filesystem>
#include <map>
#include <string>

namespace byre {

using ImageNames = std::map<Timestamp, std::string>;  // file names by capture time

// The map as a COLMAP model of the original, unrectified left images: cameras with distortion, poses of these cameras,
// key points in original pixels. Positions are in the map's frame. Point n has id n + 1 in the model, image n likewise
// n + 1. Points with one observing keyframe (depth from disparity) are omitted, because COLMAP requires two views.
// Images without an entry in names are called "<time in nanoseconds>.png".
ColmapModel colmap_model_of(const StoredMap& stored, const ImageNames& names);

// File names of a recording's images, of the left camera or of the right one if it is used alone. Throws InputError
// like open_recording, and for a video, which has no image files.
ImageNames names_of_images(const std::filesystem::path& recording, const OpenOptions& options = {});

}  // namespace byre
