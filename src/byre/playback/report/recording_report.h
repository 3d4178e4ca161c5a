#pragma once

#include "byre/io/bag/bag.h"
#include "byre/io/recording/recording_check.h"
#include "byre/playback/report/report.h"

#include <string>
#include <vector>

namespace byre {

// "20.0 Hz, 2 gaps; 1000 features, 56 % matched in both images, row error 0.25 px". Ends after the number of features
// for one camera, and if most images have none.
std::string summary_of(const RecordingCheck& check);

Report check_report(const RecordingCheck& check, const std::vector<Finding>& findings, const std::string& recording);

// {"source": "stamps", "clock_steps": [{"frame": 70, "by_s": -0.62}], "late": 0, "repeated": 0, "unstamped": 0}
nlohmann::ordered_json times_json(const TimeCorrections& times);

// Content of a bag. bag: its path.
Report bag_report(const BagContent& content, const std::string& bag);

}  // namespace byre
