#pragma once

#include "byre/geometry/evaluation/evaluate.h"
#include "byre/playback/report/report.h"

#include <string>

namespace byre {

// Begins with the protocol. File names are only printed.
Report evaluation_report(const EvaluationReport& evaluation, const std::string& estimate_file,
                         const std::string& truth_file);

}  // namespace byre
