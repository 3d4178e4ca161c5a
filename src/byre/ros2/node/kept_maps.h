#pragma once

#include <filesystem>

namespace byre {

// Path of the previous version of a map: barn.previous.byre for barn.byre.
std::filesystem::path previous_map(const std::filesystem::path& map);

// Copies the map to its previous version before it is replaced. Does nothing without a map file. Each name refers to a
// complete map at any time. Throws InputError on failure.
void keep_as_previous(const std::filesystem::path& map);

}  // namespace byre
