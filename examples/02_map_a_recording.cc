// Maps a recording, saves the map, and writes the robot's trajectory.
//
//   02_map_a_recording RECORDING MAP [TRAJECTORY]

#include "byre/byre.h"

#include <cstdio>

namespace {

void map(const char* path, const char* map_path, const char* trajectory_path) {
  const auto recording = byre::open_recording(path, {});
  byre::SlamOptions options;
  options.workers = byre::Workers::repeatable;  // deterministic: same recording, same map
  options.recording = path;
  byre::Slam slam = byre::Slam::mapping(recording->calibration(), options);
  for (int i = 0; i < recording->size(); ++i) {
    if (const auto frame = recording->read(i)) slam.process(view_of(*frame));
  }
  slam.finish();
  slam.save(map_path);
  if (trajectory_path != nullptr) byre::write_trajectory(slam.trajectory(), trajectory_path);
  std::printf("%d frames, %d keyframes, %d points\n", slam.frames(), slam.keyframes(), slam.points());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: 02_map_a_recording RECORDING MAP [TRAJECTORY]\n");
    return 2;
  }
  try {
    map(argv[1], argv[2], argc > 3 ? argv[3] : nullptr);
  } catch (const byre::InputError& error) {
    std::fprintf(stderr, "02_map_a_recording: %s\n", error.what());
    return 3;
  }
  return 0;
}
