#pragma once

#include <filesystem>

namespace byre {

// Where the map is kept that a saved one has taken the place of: of barn.byre barn.previous.byre.
std::filesystem::path previous_map(const std::filesystem::path& map);

// Keeps a map as the previous one, before another takes its place; nothing where there is none. The map stays where it
// is, and at any moment there is a whole one of each name. Throws InputError where that cannot be done.
void keep_as_previous(const std::filesystem::path& map);

}  // namespace byre
