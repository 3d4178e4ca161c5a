#pragma once

#include "byre/frame_report.h"

#include <optional>
#include <string>

namespace byre {

// What a node counts, since it began.
struct NodeFigures {
  int images = 0;    // left images that came
  int left_out = 0;  // left images left out, as newer ones were there
  int frames = 0;    // frames handed to tracking
  std::optional<FrameReport> last{};
};

// As Prometheus reads it, https://prometheus.io/docs/instrumenting/exposition_formats
std::string metrics_text(const NodeFigures& figures);

}  // namespace byre
