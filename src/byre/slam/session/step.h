#pragma once

#include "byre/frame_report.h"
#include "byre/slam/frame/frame_budget.h"
#include "byre/slam/session/robot_state.h"

#include <optional>
#include <vector>

namespace byre {

// Measurements of one frame.
struct StepInput {
  const Frame& frame;                     // rectified
  std::optional<BodyMotion> motion = {};  // motion of the body since the last frame; empty: unknown
  std::optional<BodyTilt> tilt = {};      // measured by accelerations, constrains dead reckoning; empty: unknown
  FrameBudget* budget = nullptr;          // time limit of the frame; nullptr: none. The caller begins and ends it
};

// A job to run. Its result is delivered to the state before a later frame, see deliver().
struct JobRequest {
  JobKind kind = JobKind::local;
  Job job;
};

struct Step {
  FrameReport report;
  std::vector<JobRequest> jobs = {};  // to run
};

// The method for one frame: applies results of jobs, localises the frame in the maps, updates the pose, extends the
// online map and assesses the pose. Deterministic in its arguments. Frames are in order of time. The state is updated
// in place, so that an exception for lack of memory does not lose the map.
Step step(RobotState& state, const StepInput& input, const SessionOptions& options);

// The requested jobs of a state, which are in flight afterwards.
std::vector<JobRequest> take_requests(RobotState& state);

// Stores the result of a job in flight, for the next step.
void deliver(JobKind kind, FinishedJob finished, RobotState& state);

}  // namespace byre
