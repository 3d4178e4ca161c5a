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

// A made-up camera that plays a EuRoC recording, as the environment says:
//   BYRE_STAND_IN_RECORDING   its folder
//   BYRE_STAND_IN_FRAMES      FIRST:COUNT, all unless given
//   BYRE_STAND_IN_SPEED       how many times faster than recorded; 0: a frame whenever there is a buffer for it
//   BYRE_STAND_IN_FORMAT      GREY (unless given), YUYV or MJPG
//   BYRE_STAND_IN_STAMPS      recorded (unless given), or monotonic: those of the kernel's clock
//   BYRE_STAND_IN_LOSE        DEVICE:FRAME,...: frames that its driver loses
//   BYRE_STAND_IN_DAMAGE      DEVICE:FRAME,...: frames that its driver calls damaged
//   BYRE_STAND_IN_SKEW        DEVICE:MICROSECONDS,...: added to its stamps
//   BYRE_STAND_IN_UNPLUG      DEVICE:FRAME:MILLISECONDS: before that frame it is unplugged for so long
// DEVICE is left, right or both: /dev/video-stand-in-left and so on; both gives the images side by side.
class Device {
 public:
  static constexpr std::size_t kBuffers = 8;

  // The device at a path; nullptr if it is none.
  static Device* find(const std::string& path);

  explicit Device(const std::string& name);

  bool is_away();
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

  // A filled buffer.
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
    std::string left, right;  // file names
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
  std::optional<Clock::time_point> begun_;  // due time of the first frame
  std::optional<Clock::time_point> away_until_;
  std::size_t next_ = 0;         // frame
  std::uint32_t opened_at_ = 0;  // frame with sequence number 0 since opening
  std::deque<std::uint32_t> queued_;
  std::deque<std::pair<std::uint32_t, std::size_t>> done_;  // buffer, frame
};

}  // namespace byre::stand_in
