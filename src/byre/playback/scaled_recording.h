#pragma once

#include "byre/recording.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <memory>
#include <string>

namespace byre {

// Name of a recording in maps: that of its folder or file.
std::string source_name(const std::filesystem::path& recording);

// Recording for mapping or a mission. Monocular mapping has no metric scale, so a lever arm in metres is meaningless:
// then the camera frame serves as the body frame.
struct ScaledRecording {
  std::unique_ptr<Recording> recording;
  bool is_metric = true;
  Pose body_from_camera;  // identity if metric

  // Path of the body, given the poses of a run.
  Trajectory path_of(const Trajectory& world_from_body) const;
};

// Throws InputError as open_recording does. A metric map provides the scale for one camera.
ScaledRecording open_scaled(const std::filesystem::path& path, const FrameRange& range, const OpenOptions& options,
                            bool has_metric_map);

}  // namespace byre
