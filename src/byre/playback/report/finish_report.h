#pragma once

#include "byre/slam/system/slam_impl.h"

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

// Rows of a name and a value.
std::string to_text(const FinishResult& finishing);
nlohmann::ordered_json to_json(const FinishResult& finishing);

}  // namespace byre
