// A robot's main loop: SLAM always takes the newest stereo pair from a free-running camera.
//
//   01_live_stereo RECORDING
//
// A recording replaces the camera here. Call submit() in your driver's callback.

#include "byre/byre.h"

#include <chrono>
#include <iostream>
#include <thread>

void print(const byre::FrameReport& report) {
  std::cout << byre::to_seconds(report.time) << " s  " << to_string(report.state);
  if (report.map_from_body) std::cout << "  at " << report.map_from_body->translation.transpose() << " m";
  if (report.input != byre::InputFault::none) std::cout << "  (" << to_string(report.input) << ")";
  std::cout << "\n";
}

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::cerr << "usage: 01_live_stereo RECORDING\n";
    return 2;
  }
  const auto camera = byre::open_recording(argv[1], {});
  byre::Slam slam = byre::Slam::mapping(camera->calibration());
  const auto start = std::chrono::steady_clock::now() - camera->times().front();
  for (int i = 0; i < camera->size(); ++i) {
    auto frame = camera->read(i);
    std::this_thread::sleep_until(start + camera->times()[static_cast<std::size_t>(i)]);
    if (frame) slam.submit(std::move(*frame), print);
  }
  std::cout << slam.frames() << " frames, " << slam.frames(byre::InputFault::replaced) << " missed, "
            << slam.keyframes() << " keyframes\n";
} catch (const byre::InputError& error) {
  std::cerr << "01_live_stereo: " << error.what() << "\n";
  return 3;
}
