#pragma once

#include <filesystem>

namespace byre {

// Path of the version of a map before the present one: of barn.byre barn.previous.byre.
std::filesystem::path previous_map(const std::filesystem::path& map);

// Keeps the map of this path as its previous version, before another one replaces it; does nothing if it is no map
// file. At any moment there is a whole map under each name. Throws InputError if that cannot be done.
void keep_as_previous(const std::filesystem::path& map);

}  // namespace byre
