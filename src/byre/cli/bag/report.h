#pragma once

#include "byre/bag/bag.h"

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace byre::cli {

// What a bag holds, for people and for programs.
std::string describe(const BagContent& content, const std::filesystem::path& bag);
nlohmann::ordered_json bag_json(const BagContent& content, const std::filesystem::path& bag);

}  // namespace byre::cli
