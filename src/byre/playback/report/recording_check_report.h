#pragma once

#include "byre/io/recording/recording_check.h"

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace byre {

// "20.0 Hz, 2 gaps; 1000 features, 56 % of them in both images, 0.25 px off their row". Ends after the number of
// features for one camera, and if most images have none.
std::string summary_of(const RecordingCheck& check);

std::string describe(const RecordingCheck& check, const std::vector<Finding>& findings);

// {"source": "stamps", "clock_steps": [{"frame": 70, "by_s": -0.62}], "late": 0, "repeated": 0, "unstamped": 0}
nlohmann::ordered_json times_json(const TimeCorrections& times);

nlohmann::ordered_json check_json(const RecordingCheck& check, const std::vector<Finding>& findings);

}  // namespace byre
