#pragma once

#include <filesystem>
#include <vector>

namespace byre {

// Existing files that belong to an input of several files, so that outputs do not overwrite them. Never throw; for an
// invalid input they list the files that it seems to have.

// Files of a recording of any format: images, lists, calibrations and truth.
std::vector<std::filesystem::path> files_of_recording(const std::filesystem::path& recording);

// Files of a floor plan in the sense of read_floor_plan: with its image, and the world file of the image.
std::vector<std::filesystem::path> files_of_floor_plan(const std::filesystem::path& plan);

// Files of a COLMAP model in its folder.
std::vector<std::filesystem::path> files_of_colmap_model(const std::filesystem::path& folder);

// Image files in a folder and its subfolders; for a file, the file itself.
std::vector<std::filesystem::path> images_below(const std::filesystem::path& folder);

// Path of the picks by which a map was registered: next to the map, with the extension ".picks.csv".
std::filesystem::path picks_path(const std::filesystem::path& map);

}  // namespace byre
