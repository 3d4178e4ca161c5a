#pragma once

#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_trajectory_scene.h"

#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

namespace byre {

// A small rendered stereo recording with truth, in EuRoC format; the destructor removes its files.
class RenderedFixture {
 public:
  RenderedFixture(const std::string& name, int frames, double frame_rate_hz)
      : RenderedFixture(name, euroc_like_calibration(4),
                        figure_eight_trajectory(frames, frame_rate_hz, 3.0, 0.012 * frames,
                                                euroc_like_calibration(4).body_from_left)) {}
  RenderedFixture(const std::string& name, const Calibration& calibration, Trajectory truth,
                  const RenderedRoomOptions& room = {})
      : folder_(std::filesystem::path(testing::TempDir()) / (name + "." + std::to_string(getpid()))),
        truth_(std::move(truth)) {
    write_euroc_recording(RenderedRoom(room), calibration, truth_, folder_, {});
  }
  ~RenderedFixture() { std::filesystem::remove_all(folder_); }
  RenderedFixture(const RenderedFixture&) = delete;
  RenderedFixture& operator=(const RenderedFixture&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  const Trajectory& truth() const { return truth_; }
  std::filesystem::path image(const std::string& camera, std::size_t frame) const {
    return folder_ / "mav0" / camera / "data" / (std::to_string(truth_[frame].time.count()) + ".png");
  }

  // Rendered once and shared by all tests, which must not modify it.
  static const RenderedFixture& shared() {
    static const RenderedFixture recording("byre_cli_room", 24, 20.0);
    return recording;
  }

 private:
  std::filesystem::path folder_;
  Trajectory truth_;
};

}  // namespace byre
