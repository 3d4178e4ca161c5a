#pragma once

#include "byre/io/bag/bag.h"

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

// Content of a bag as text and JSON. bag: its path.
std::string describe(const BagContent& content, const std::string& bag);
nlohmann::ordered_json bag_json(const BagContent& content, const std::string& bag);

}  // namespace byre
