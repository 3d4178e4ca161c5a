#pragma once

#include <filesystem>
#include <string_view>

namespace byre {

// A file that comes with byre, by its path in share/byre: in the folder that the environment's BYRE_DATA names; in an
// installation that may have been moved, above the running program or the shared object that this is part of; where
// byre was configured to be installed; in the source tree. Throws InputError, with the remedy, when it is in none of
// them.
std::filesystem::path find_data_file(const std::filesystem::path& name, std::string_view remedy);

}  // namespace byre
