#pragma once

#include "byre/cli/demo_findings.h"
#include "byre/cli/interrupt.h"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace byre::cli {

struct DemoOptions {
  std::filesystem::path output = "byre_demo";  // folder for the page, the recordings and what is made of them
  std::uint64_t seed = 1;                      // of the barn
  double duration_s = 50.0;                    // of the first visit; the second takes a quarter longer
  double frame_rate_hz = 8.0;
  int image_divisor = 1;                            // 1: 752 x 480 pixels
  std::optional<std::filesystem::path> vocabulary;  // else the one that comes with byre
  bool quiet = false;
};

// Renders two visits to the simulated cowshed, maps the first, lays its map on the floor plan, and runs the second with
// each arm. Tells on the standard error stream what it is doing unless quiet. Empty when Ctrl-C stopped it. Throws
// InputError when the folder holds recordings already, and runtime_error when the first visit gives no map.
std::optional<DemoFindings> run_demo(const DemoOptions& options, const InterruptCatcher& interrupt);

}  // namespace byre::cli
