#pragma once

#include "byre/frame_report.h"

#include <optional>
#include <string>

namespace byre {

// Counters of a node since its start.
struct NodeCounters {
  int images = 0;   // left images received
  int skipped = 0;  // left images skipped for newer ones
  int frames = 0;   // frames tracked
  std::optional<FrameReport> last{};
};

// Prometheus text format, https://prometheus.io/docs/instrumenting/exposition_formats
std::string metrics_text(const NodeCounters& counters);

}  // namespace byre
