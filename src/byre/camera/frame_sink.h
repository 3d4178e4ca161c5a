#pragma once

#include "byre/calibration.h"
#include "byre/image.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace byre {

// Where the frames of cameras are written to, one by one, so that what was written is there however it ends.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // Throws InputError when it cannot be written.
  virtual void write(const ImageFrame& frame) = 0;
  // To be called once, after the last frame.
  virtual void finish() {}
};

// What is known of the cameras before the first frame.
struct RecordedCameras {
  bool has_right = false;
  double rate_hz = 0.0;
  std::optional<Calibration> calibration{};  // written with the images
};

// A path that ends in .mcap is a file of messages of ROS 2, any other the folder of a EuRoC recording. Throws
// InputError when it cannot be written, and for a folder that holds a recording already.
std::unique_ptr<FrameSink> open_sink(const std::filesystem::path& path, const RecordedCameras& cameras);

}  // namespace byre
