#pragma once

#include <filesystem>
#include <string_view>

namespace byre {

// Path of a file that comes with byre, given its path in share/byre. Searched in this order: the folder in the
// environment variable BYRE_DATA; a relocated installation above the running program or the shared object of this code;
// the configured install folder; share/byre of /usr/local and /usr; the source tree. Throws InputError with the remedy
// if it is in none of them.
std::filesystem::path find_data_file(const std::filesystem::path& name, std::string_view remedy);

}  // namespace byre
