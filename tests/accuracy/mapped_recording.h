#pragma once

#include "byre/place/vocabulary.h"
#include "byre/recording.h"
#include "byre/session/session.h"
#include "byre/trajectory_error.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// What byre makes of a recording, with the options a user gets. Trajectories are world_from_body.
struct MappedRecording {
  std::vector<Timestamp> frame_times;
  Trajectory causal;  // poses as they were published when their frame came
  Trajectory final;   // poses of all these frames after the last correction
  Map map{Origin::online};
};

MappedRecording map_recording(const std::filesystem::path& folder, const FrameRange& range,
                              std::unique_ptr<Executor> executor, const OpenOptions& options = {});

// Frames that have no final pose.
int frames_without_pose(const MappedRecording& mapped);

// Root mean square of the position error after rigid alignment, metres; infinite when the estimate cannot be aligned.
double position_error(const Trajectory& estimate, const Trajectory& truth, const AssociationOptions& options = {});

// The bytes of the file that the trajectory is written to.
std::string written(const Trajectory& trajectory);

// Where a real recording lies; empty when it is not there.
std::optional<std::filesystem::path> find_recording(const std::filesystem::path& name);

// Why a test without its recording is skipped, and how to have it run.
std::string missing(const std::filesystem::path& name);

// What byre brings along.
const Vocabulary& shipped_vocabulary();

}  // namespace byre
