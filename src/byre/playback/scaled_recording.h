#pragma once

#include "byre/recording.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <memory>

namespace byre {

// A recording that is to be mapped, or run on a map. One camera that maps from nothing knows no metres, so the arm from
// it to the body means nothing to it either: then the recording says that its camera is the body.
struct ScaledRecording {
  std::unique_ptr<Recording> recording;
  bool is_metric = true;
  Pose body_from_camera;  // identity where the recording is metric

  // The path of what moves along the run's poses.
  Trajectory path_of(const Trajectory& world_from_body) const;
};

// Throws InputError as open_recording does. A map that is there tells one camera the scale.
ScaledRecording open_scaled(const std::filesystem::path& path, const FrameRange& range, const OpenOptions& options,
                            bool has_metric_map);

}  // namespace byre
