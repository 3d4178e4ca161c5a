#pragma once

#include "byre/bag/bag.h"

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

// What a bag holds, for people and for programs. bag: its path.
std::string describe(const BagContent& content, const std::string& bag);
nlohmann::ordered_json bag_json(const BagContent& content, const std::string& bag);

}  // namespace byre
