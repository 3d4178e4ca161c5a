#pragma once

#include "byre/benchmark/demo/findings.h"
#include "byre/playback/play.h"
#include "byre/simulation/cowshed/cowshed_rendering.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace byre {

struct DemoOptions {
  std::filesystem::path output = "byre_demo";  // folder for page, recordings and results
  std::uint64_t seed = 1;
  double duration_s = 50.0;  // seconds of the first visit; the second is a quarter longer
  bool animation = false;    // whether to draw an animation of the hybrid run
  double frame_rate_hz = 8.0;
  int image_divisor = 1;                            // 1: 752 x 480 pixels
  std::optional<std::filesystem::path> vocabulary;  // empty: byre's own
};

// Callbacks for rendering, running and progress.
struct DemoHooks {
  std::function<bool()> should_stop;
  std::function<void(const std::string& stage)> before_stage;  // "1 of 6: rendering the first visit, by day"
  std::function<Rendering(const CowshedRecordingOptions& options, const std::filesystem::path& folder)> render;
  std::function<RunResult(Slam& slam, Recording& recording, const PlayHooks& hooks)> play;
};

// Renders two visits to the simulated cowshed, maps the first, registers its map on the floor plan, and runs the second
// with each arm. The second visit starts at another place; no arm is given a pose there. Empty when stopped. Throws
// InputError when the folder already holds recordings, and runtime_error when the first visit gives no map.
std::optional<DemoFindings> run_demo(const DemoOptions& options, const DemoHooks& hooks);

}  // namespace byre
