// Renders a small stereo recording of a made-up room, with exact ground truth, in the format of the EuRoC data set:
// something to run byre on where no data set is at hand. The same options give the same bytes.

#include "byre/input/input_error.h"
#include "byre/simulation/rendered_room.h"
#include "byre/simulation/simulated_mission.h"

#include <cstdio>
#include <filesystem>

#include <CLI/CLI.hpp>

namespace {

struct Options {
  std::filesystem::path folder;
  int frames = 200;
  double frame_rate_hz = 20.0;
  double radius_m = 1.2;
  double laps = 1.0;
  int divisor = 2;
  std::uint64_t seed = 1;
};

// The left camera flies in a circle; the ground truth is where that puts the body.
byre::Trajectory body_trajectory(const Options& options, const byre::Calibration& calibration) {
  const byre::Pose camera_from_body = byre::inverse(calibration.body_from_left);
  byre::Trajectory trajectory =
      byre::circling_trajectory(options.frames, options.frame_rate_hz, options.radius_m, options.laps);
  for (byre::StampedPose& sample : trajectory) {
    const byre::Pose world_from_camera = sample.world_from_body;
    sample.world_from_body = world_from_camera * camera_from_body;
  }
  return trajectory;
}

void show_progress(int done, int total) {
  std::fprintf(stderr, "\r%d of %d stereo pairs%s", done, total, done == total ? "\n" : "");
}

void render(const Options& options) {
  byre::RenderedRoomOptions room;
  room.seed = options.seed;
  const byre::Calibration calibration = byre::euroc_like_calibration(options.divisor);
  byre::write_euroc_recording(byre::RenderedRoom(room), calibration, body_trajectory(options, calibration),
                              options.folder, show_progress);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Renders a stereo recording of a made-up room in EuRoC format.");
  app.add_option("folder", options.folder, "Where to write the recording")->required();
  app.add_option("--frames", options.frames, "Stereo pairs")->check(CLI::Range(2, 100000))->capture_default_str();
  app.add_option("--rate", options.frame_rate_hz, "Stereo pairs a second")
      ->check(CLI::Range(1.0, 200.0))
      ->capture_default_str();
  app.add_option("--radius", options.radius_m, "Of the circle the camera flies, metres")
      ->check(CLI::Range(0.0, 2.5))
      ->capture_default_str();
  app.add_option("--laps", options.laps, "Of that circle")->capture_default_str();
  app.add_option("--divisor", options.divisor, "Of EuRoC's resolution of 752 x 480")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Of the room and the noise")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    render(options);
  } catch (const byre::InputError& error) {
    std::fprintf(stderr, "render_room: %s\n", error.what());
    return 1;
  }
  return 0;
}
