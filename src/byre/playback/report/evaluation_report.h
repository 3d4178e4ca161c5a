#pragma once

#include "byre/geometry/evaluation/evaluate.h"

#include <string>

namespace byre {

// Both begin with the protocol. File names are only printed.
std::string to_text(const EvaluationReport& report, const std::string& estimate_file, const std::string& truth_file);
std::string to_json(const EvaluationReport& report, const std::string& estimate_file, const std::string& truth_file);

}  // namespace byre
