#pragma once

#include <filesystem>
#include <vector>

namespace byre {

// The files that are read where a thing of several files is named, as far as they are there: for who must not destroy
// them. Never throw; what is no such thing has the files that it seems to have.

// Files of a recording of any format, or of the folder or the video that is one: images, lists, calibrations and truth.
std::vector<std::filesystem::path> files_of_recording(const std::filesystem::path& recording);

// Files of a floor plan, as read_floor_plan takes it: with its image and the world file of that.
std::vector<std::filesystem::path> files_of_floor_plan(const std::filesystem::path& plan);

// Files of a COLMAP model, in its folder.
std::vector<std::filesystem::path> files_of_colmap_model(const std::filesystem::path& folder);

// The image files in a folder and in those below it; a file is its own.
std::vector<std::filesystem::path> images_below(const std::filesystem::path& folder);

// Where picks are kept that a map was registered by: beside it, with the extension ".picks.csv".
std::filesystem::path picks_path(const std::filesystem::path& map);

}  // namespace byre
