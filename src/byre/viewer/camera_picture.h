#pragma once

#include "byre/viewer/picture.h"
#include "byre/viewer/scene.h"

#include <string>

namespace byre {

struct CameraPictureOptions {
  std::string title;
  bool panel = true;     // health beside the image
  HealthOptions health;  // limits that are marked on the meters
};

// What the camera saw with the map points found in it, offline ones green discs and online ones purple diamonds;
// matches that are not where the pose has their points are crosses. Precondition: the image is not empty.
Picture camera_picture(const FrameScene& scene, const CameraPictureOptions& options = {});

}  // namespace byre
