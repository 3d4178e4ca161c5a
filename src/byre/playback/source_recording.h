#pragma once

#include <filesystem>
#include <string>

namespace byre {

// Name of a recording in maps: that of its folder or file.
std::string source_name(const std::filesystem::path& recording);

}  // namespace byre
