#pragma once

#include "byre/features/extract.h"
#include "byre/odometry/odometry_calibrator.h"
#include "byre/slam/session/session.h"

#include <cstdint>
#include <string_view>

namespace byre {

// Threads of mapping.
//   same_thread  on the frame thread ("inline")
//   paced        on workers; results are applied a fixed number of frames later (constants below): repeatable
//   live         on workers; results are applied when ready; recordings are played in real time
enum class Pace : std::uint8_t { same_thread, paced, live };

// Name of the command line.
std::string_view name_of(Pace pace);

inline constexpr int kPacedLatency = 4;             // frames, for mapping jobs
inline constexpr int kPacedCorrectionLatency = 40;  // frames, for corrections of the whole map
inline constexpr int kPacedSearchLatency = 6;       // frames, for searches in an offline map

// Options of a Slam, each with a name in the option table.
struct MethodOptions {
  Pace pace = Pace::paced;
  ExtractOptions extract;
  SessionOptions session;
  bool self_calibrate = true;  // refine the given calibration from the map
  SelfCalibrationOptions self_calibration;
  bool close_loops = true;    // place recognition and finishing of the map
  bool keep_pictures = true;  // whether mapping keeps pictures of keyframes
  bool use_saved_extrinsics = true;
  MotionLimits motion_limits;
  // Lower bound of the relative standard deviation of a monocular map's scale, if measured by wheels only.
  double wheel_scale_sigma = 0.02;
  double frame_deadline_ms = 0.0;  // wall time limit per frame, see FrameBudget
};

}  // namespace byre
