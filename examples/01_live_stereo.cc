// A robot's main loop: SLAM always takes the newest stereo pair from a free-running camera.
//
//   01_live_stereo RECORDING
//
// A recording replaces the camera here. Replace play() by your driver's callback.

#include "byre/byre.h"

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

namespace {

// Holds the newest frame. A slow reader skips frames; the writer never waits.
class NewestFrame {
 public:
  void put(byre::ImageFrame frame) {
    const std::scoped_lock lock(mutex_);
    if (frame_) ++dropped_;
    frame_ = std::move(frame);
    changed_.notify_one();
  }
  void close() {
    const std::scoped_lock lock(mutex_);
    is_closed_ = true;
    changed_.notify_one();
  }
  // Waits for a new frame; empty once there are no more.
  std::optional<byre::ImageFrame> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return frame_ || is_closed_; });
    return std::exchange(frame_, std::nullopt);
  }
  int missed() const {
    const std::scoped_lock lock(mutex_);
    return dropped_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<byre::ImageFrame> frame_;
  bool is_closed_ = false;
  int dropped_ = 0;
};

// Simulates the camera: frames at their own times.
void play(byre::Recording& recording, NewestFrame& newest) {
  const auto start = std::chrono::steady_clock::now() - recording.times().front();
  for (int i = 0; i < recording.size(); ++i) {
    auto frame = recording.read(i);
    std::this_thread::sleep_until(start + recording.times()[static_cast<std::size_t>(i)]);
    if (frame) newest.put(std::move(*frame));
  }
  newest.close();
}

void print_report(const byre::FrameReport& report) {
  const std::string_view state = byre::to_string(report.state);
  std::printf("%.3f s  %-12.*s", byre::to_seconds(report.time), static_cast<int>(state.size()), state.data());
  if (report.map_from_body) {
    const Eigen::Vector3d& at = report.map_from_body->translation;
    std::printf("  x %.3f  y %.3f  z %.3f m", at.x(), at.y(), at.z());
  }
  if (report.input != byre::InputFault::none) {
    const std::string_view fault = byre::to_string(report.input);
    std::printf("  (%.*s)", static_cast<int>(fault.size()), fault.data());
  }
  std::printf("\n");
}

void run(const char* path) {
  const auto recording = byre::open_recording(path, {});
  byre::Slam slam = byre::Slam::mapping(recording->calibration());
  NewestFrame newest;
  std::jthread camera([&] { play(*recording, newest); });
  while (const auto frame = newest.take()) print_report(slam.process(view_of(*frame)));
  std::printf("%d frames, %d missed, %d keyframes\n", slam.frames(), newest.missed(), slam.keyframes());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: 01_live_stereo RECORDING\n");
    return 2;
  }
  try {
    run(argv[1]);
  } catch (const byre::InputError& error) {
    std::fprintf(stderr, "01_live_stereo: %s\n", error.what());
    return 3;
  }
  return 0;
}
