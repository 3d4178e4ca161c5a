#pragma once

#include "byre/map/map_file.h"

#include <string_view>

namespace byre {

inline constexpr int kMaxImageSize = 16384;  // pixels, width and height

// What is wrong with a value of a map that is to be kept: a few words such as "has no proper pose", empty for a sound
// one. Reading a map file, and looking for the faults of a map, ask the same.
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
