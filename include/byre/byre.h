#pragma once

// The whole library. A robot's program needs byre/slam.h only; see docs/reference/library.md.

#include "byre/alignment.h"
#include "byre/body_motion.h"
#include "byre/calibration.h"
#include "byre/calibration_file.h"
#include "byre/features.h"
#include "byre/floor_plan.h"
#include "byre/frame_cuts.h"
#include "byre/frame_report.h"
#include "byre/health.h"
#include "byre/image.h"
#include "byre/input_error.h"
#include "byre/motion_warning.h"
#include "byre/pose.h"
#include "byre/pose_hint.h"
#include "byre/recording.h"
#include "byre/rig.h"
#include "byre/slam.h"
#include "byre/trajectory.h"
#include "byre/trajectory_error.h"
#include "byre/trajectory_file.h"
