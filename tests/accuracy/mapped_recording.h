#pragma once

#include "byre/place/vocabulary.h"
#include "byre/recording.h"
#include "byre/slam/session/session.h"
#include "byre/trajectory_error.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Result of a run on a recording with default options. Trajectories are world_from_body.
struct MappedRecording {
  std::vector<Timestamp> frame_times;
  Trajectory causal;  // published poses
  Trajectory final;   // poses of all these frames after the last correction
  MapGraph map{Origin::online};
};

MappedRecording map_recording(const std::filesystem::path& folder, const FrameRange& range,
                              std::unique_ptr<Executor> executor, const OpenOptions& options = {});

int frames_without_pose(const MappedRecording& mapped);

// RMSE of positions after rigid alignment, metres; infinite when alignment is impossible.
double position_error(const Trajectory& estimate, const Trajectory& truth, const AssociationOptions& options = {});

// Content of the file that the trajectory is written to.
std::string written(const Trajectory& trajectory);

// Folder of a real recording; empty when it is missing.
std::optional<std::filesystem::path> find_recording(const std::filesystem::path& name);

// Skip message for a missing recording, with the remedy.
std::string missing(const std::filesystem::path& name);

// byre's own vocabulary.
const Vocabulary& shipped_vocabulary();

}  // namespace byre
