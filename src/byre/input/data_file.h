#pragma once

#include <filesystem>
#include <string_view>

namespace byre {

// A file that comes with byre, by its path in share/byre: beside the running program, in an installation that may have
// been moved, then where byre was installed, then in the source tree. Throws InputError, with the remedy, when it is in
// none of them.
std::filesystem::path find_data_file(const std::filesystem::path& name, std::string_view remedy);

}  // namespace byre
