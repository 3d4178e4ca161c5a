#include "byre/session/session_options.h"

namespace byre {

MappingOptions mapping_options(const SessionOptions& options) {
  MappingOptions mapping;
  mapping.window = options.window;
  mapping.max_relative_depth_sigma = options.max_relative_depth_sigma;
  mapping.redundant_share = options.redundant_share;
  mapping.offline_weight = options.track.offline_weight;
  return mapping;
}

FinishOptions finish_options(const SessionOptions& options) {
  FinishOptions finish;
  finish.loops = options.loops;
  finish.global.mapping = mapping_options(options);
  return finish;
}

}  // namespace byre
