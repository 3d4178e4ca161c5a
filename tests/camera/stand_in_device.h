#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace byre::stand_in {

// A simulated camera that plays a EuRoC recording, configured by environment variables:
//   BYRE_STAND_IN_RECORDING   its folder
//   BYRE_STAND_IN_FRAMES      FIRST:COUNT; default: all
//   BYRE_STAND_IN_SPEED       playback speed relative to the recording; 0: a frame whenever a buffer is queued
//   BYRE_STAND_IN_FORMAT      GREY (default), YUYV or MJPG
//   BYRE_STAND_IN_STAMPS      recorded (default), or monotonic: stamps of the kernel's clock
//   BYRE_STAND_IN_LOSE        DEVICE:FRAME,...: frames that the driver loses
//   BYRE_STAND_IN_DAMAGE      DEVICE:FRAME,...: frames that the driver flags as damaged
//   BYRE_STAND_IN_SKEW        DEVICE:MICROSECONDS,...: added to the stamps
//   BYRE_STAND_IN_UNPLUG      DEVICE:FRAME:MILLISECONDS: duration of an unplugging before that frame
// DEVICE is left, right or both, as in /dev/video-stand-in-left; both gives side-by-side images.
class Device {
 public:
  static constexpr std::size_t kBuffers = 8;

  static Device* find(const std::string& path);

  explicit Device(const std::string& name);

  bool is_unplugged();
  bool open();  // false if already open
  void close() { *this = stopped(); }

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t bytes() const;  // size of an image buffer
  std::uint32_t format() const { return format_; }
  double rate_hz() const { return rate_hz_; }

  void start();
  void stop();
  void queue(std::uint32_t buffer) { advance(), queued_.push_back(buffer); }
  bool is_ready();

  struct Filled {
    std::uint32_t buffer = 0;
    std::uint32_t sequence = 0;
    std::int64_t stamp_us = 0;
    bool is_damaged = false;
    std::size_t bytes = 0;
  };
  // Writes the next image into its buffer. memory: address of the first buffer.
  std::optional<Filled> take(std::uint8_t* memory);

  std::map<std::uint32_t, int> controls;  // values by id

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame {
    std::int64_t time_ns = 0;
    std::string left, right;
  };

  Device stopped() const;
  void advance();
  cv::Mat image_of(const Frame& frame) const;

  std::string name_;
  std::vector<Frame> frames_;
  std::set<int> lost_, damaged_;
  std::int64_t skew_us_ = 0;
  std::optional<std::pair<int, int>> unplugging_;  // frame, milliseconds
  std::uint32_t format_ = 0;
  double speed_ = 1.0;
  bool has_monotonic_stamps_ = false;
  int width_ = 0, height_ = 0;
  double rate_hz_ = 20.0;

  bool is_open_ = false, is_streaming_ = false;
  std::optional<Clock::time_point> start_;  // due time of the first frame
  std::optional<Clock::time_point> unplugged_until_;
  std::size_t next_ = 0;         // frame
  std::uint32_t opened_at_ = 0;  // frame with sequence number 0 since opening
  std::deque<std::uint32_t> queued_;
  std::deque<std::pair<std::uint32_t, std::size_t>> done_;  // buffer, frame
};

}  // namespace byre::stand_in
