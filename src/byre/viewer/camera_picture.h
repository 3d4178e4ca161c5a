#pragma once

#include "byre/slam/frame/health.h"
#include "byre/viewer/picture.h"
#include "byre/viewer/scene.h"

#include <string>

namespace byre {

struct CameraPictureOptions {
  std::string title;
  bool panel = true;       // health next to the image
  int width = 0;           // pixels, of the image; 0: chosen by its size
  HealthOptions health{};  // limits marked on the meters
};

// Camera image with matched map points: offline points as green discs, online points as purple diamonds, outliers as
// crosses. Precondition: the image is not empty.
Picture camera_picture(const FrameScene& scene, const CameraPictureOptions& options = {});

}  // namespace byre
