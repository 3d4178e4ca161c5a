#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace byre::cli {

// Also by other names for it; neither need exist.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

std::vector<std::string> names_of(const std::vector<std::filesystem::path>& files);

}  // namespace byre::cli
