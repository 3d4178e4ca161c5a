#pragma once

#include <filesystem>

namespace byre {

// Path of the previous version of a map: barn.previous.byre for barn.byre.
std::filesystem::path previous_map(const std::filesystem::path& map);

// Keeps the map of this path as its previous version, before another map replaces it. Does nothing if there is no map
// file. At any moment each name has a whole map. Throws InputError on failure.
void keep_as_previous(const std::filesystem::path& map);

}  // namespace byre
