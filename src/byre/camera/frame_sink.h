#pragma once

#include "byre/calibration.h"
#include "byre/image.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace byre {

// Writes frames of cameras one by one, so that those written survive any termination.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // Throws InputError if the frame cannot be written.
  virtual void write(const ImageFrame& frame) = 0;
  // Call it once, after the last frame.
  virtual void finish() {}
};

// Properties of the cameras before the first frame.
struct RecordedCameras {
  bool has_right = false;
  double rate_hz = 0.0;
  std::optional<Calibration> calibration{};  // written with the images
};

// A path ending in .mcap is a file of ROS 2 messages, any other path the folder of a EuRoC recording. Throws InputError
// if it cannot be written, and for a folder that already has a recording.
std::unique_ptr<FrameSink> open_sink(const std::filesystem::path& path, const RecordedCameras& cameras);

}  // namespace byre
