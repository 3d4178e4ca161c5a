#pragma once

#include "byre/map.h"

#include <filesystem>
#include <optional>

namespace byre {

// Reads a COLMAP model (cameras, images and points3D, .bin or .txt) with its images. Each image becomes a keyframe with
// its pose in the model, in the order of their times; the body is the camera. A point of the model is kept, at its
// position, if corners of two images match it; other corners become additional points if adds_points. metres_per_unit:
// length of the model's unit; empty: the map is not metric. Throws InputError for a damaged or unsupported model, and
// for an image that is missing, damaged or of another size than its camera.
Map import_colmap(const std::filesystem::path& model, const std::filesystem::path& images,
                  const std::optional<double>& metres_per_unit = {}, bool adds_points = true);

// Writes a map as a COLMAP model of its unrectified left images to a folder, created if missing: poses, and points with
// two observations or more. Keyframe n and point n get the ids n + 1. images_of: recording whose file names the images
// get; empty: <nanoseconds>.png. Throws InputError if a file cannot be written, and for a map without calibrations.
void export_colmap(const Map& map, const std::filesystem::path& model,
                   const std::optional<std::filesystem::path>& images_of = {});

}  // namespace byre
