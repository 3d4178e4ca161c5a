#pragma once

#include "byre/map/map_file.h"

#include <string_view>

namespace byre {

inline constexpr int kMaxImageSize = 16384;  // pixels, width and height

// Fault of a value to be stored, such as "has an invalid pose"; empty if valid. For map files and find_faults().
std::string_view fault_in(const Pose& pose);
std::string_view fault_in(const Camera& camera);
std::string_view fault_in(const Calibration& calibration);
std::string_view fault_in(const RefinedCalibration& refined);
std::string_view fault_in(const SourceRecording& recording);
std::string_view fault_in(const Rig& rig);
std::string_view fault_in(const Keypoint& keypoint, const Rig& rig);
std::string_view fault_in(const Patch& patch);
std::string_view fault_in(const Sighting& sighting);
std::string_view fault_in(const MapPoint& point);
std::string_view fault_in(const PlanRegistration& registration);

bool is_unit(const Eigen::Vector3f& direction);

}  // namespace byre
