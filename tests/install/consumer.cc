// Hands a camera that gives no images to SLAM, and says what comes back.

#include "byre/slam.h"

#include <cstdio>
#include <string>

int main() {
  byre::Calibration calibration;
  calibration.left = {byre::CameraModel::pinhole, 640, 480, 400.0, 400.0, 319.5, 239.5, {}};
  byre::Slam slam = byre::Slam::mapping(calibration);
  const byre::FrameReport report = slam.process(byre::CameraImages{});
  std::printf("%s, %s\n", std::string(to_string(report.state)).c_str(), std::string(to_string(report.input)).c_str());
  return 0;
}
