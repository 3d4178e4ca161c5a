// Renders a small stereo recording of a room with exact ground truth in EuRoC format, for use without a data set.
// Deterministic in its options.

#include "byre/input_error.h"
#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_trajectory_scene.h"

#include <cstdio>
#include <filesystem>

#include <CLI/CLI.hpp>

namespace {

struct Options {
  std::filesystem::path folder;
  int frames = 200;
  double frame_rate_hz = 20.0;
  double length_m = 3.0;
  double laps = 1.0;
  int divisor = 2;
  std::uint64_t seed = 1;
};

void show_progress(int done, int total) {
  std::fprintf(stderr, "\r%d of %d stereo pairs%s", done, total, done == total ? "\n" : "");
}

void render(const Options& options) {
  byre::RenderedRoomOptions room;
  room.seed = options.seed;
  const byre::Calibration calibration = byre::euroc_like_calibration(options.divisor);
  const byre::Trajectory truth = byre::figure_eight_trajectory(options.frames, options.frame_rate_hz, options.length_m,
                                                               options.laps, calibration.body_from_left);
  byre::write_euroc_recording(byre::RenderedRoom(room), calibration, truth, options.folder, show_progress);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Renders a stereo recording of a simulated room in EuRoC format.");
  app.add_option("folder", options.folder, "Output folder of the recording")->required();
  app.add_option("--frames", options.frames, "Stereo pairs")->check(CLI::Range(2, 100000))->capture_default_str();
  app.add_option("--rate", options.frame_rate_hz, "Stereo pairs per second")
      ->check(CLI::Range(1.0, 200.0))
      ->capture_default_str();
  app.add_option("--length", options.length_m, "Length of the figure-eight path, metres")
      ->check(CLI::Range(0.1, 5.0))
      ->capture_default_str();
  app.add_option("--laps", options.laps, "Number of rounds of the path")->capture_default_str();
  app.add_option("--divisor", options.divisor, "Divisor of the EuRoC resolution, 752 x 480")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Seed of room and noise")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    render(options);
  } catch (const byre::InputError& error) {
    std::fprintf(stderr, "render_room: %s\n", error.what());
    return 1;
  }
  return 0;
}
