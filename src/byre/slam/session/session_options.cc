#include "byre/slam/session/session_options.h"

namespace byre {

MapperOptions mapper_options(const SessionOptions& options) {
  MapperOptions mapper;
  mapper.recording = options.recording;
  mapper.min_initial_points = options.min_initial_points;
  mapper.max_drift_to_fuse = options.max_drift_to_fuse;
  mapper.monocular_start = options.monocular_start;
  mapper.mapping.window = options.window;
  mapper.mapping.max_relative_depth_sigma = options.max_relative_depth_sigma;
  mapper.mapping.redundant_share = options.redundant_share;
  mapper.mapping.offline_weight = options.track.offline_weight;
  mapper.loops = options.loops;
  return mapper;
}

}  // namespace byre
