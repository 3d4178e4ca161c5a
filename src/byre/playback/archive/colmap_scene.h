#pragma once

#include "byre/map/map_file.h"
#include "byre/playback/map_from_poses_run.h"
#include "byre/simulation/rendered_scene.h"

namespace byre {

// Map of every third frame of the rendered recording, at true poses.
inline StoredMap rendered_map() {
  const RenderedFixture& rendered = RenderedFixture::shared();
  const auto recording = open_recording(rendered.folder(), {.stride = 3});
  StoredMap stored;
  stored.map = run_map_from_poses(*recording, rendered.truth(), {}, {[] { return false; }, [](int) {}}).map;
  stored.pose_source = PoseSource::given;
  stored.recordings = {{"rendered", recording->calibration(), recording->times().front(), recording->times().back()}};
  return stored;
}

}  // namespace byre
