#pragma once

#include "byre/frame_report.h"
#include "byre/input_error.h"
#include "byre/io/ros/messages.h"
#include "byre/trajectory.h"

#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// Input side of a frame.
struct CameraFrame {
  bool has_second = true;  // right or depth image
  bool expects_second = true;
  bool is_frozen = false;  // image equal to the previous one, bit by bit
  double seconds = 0.0;    // from arrival of the image to the pose
  InputFault fault = InputFault::none;
  std::optional<Timestamp> nearest_second;  // without a second image: distance to the nearest one's stamp
  std::optional<Timestamp> jump;            // jump of the stamps before this frame
};

// Monitors the cameras, and reports faults within a second. Times are of one monotonic clock.
class CameraMonitor {
 public:
  // topic: of the left images, and second: "right" or "depth", for messages; now: start time.
  CameraMonitor(std::string topic, std::string second, Timestamp now)
      : topic_(std::move(topic)), second_(std::move(second)), since_(now) {}

  void note_arrival(Timestamp now);                            // left image received
  void note_unusable(const InputError& fault, Timestamp now);  // unusable image or calibration
  void note_frame(const CameraFrame& frame, Timestamp now);
  void note_skipped(int total, Timestamp now);  // total: images skipped so far for newer ones

  ros::DiagnosticStatus status(Timestamp now) const;

  int arrived() const { return arrived_; }

 private:
  struct Recent {
    Timestamp time{};
    bool lacks_second = false;
    double seconds = 0.0;
    std::optional<Timestamp> nearest_second{};
  };
  struct Finding {
    std::byte level{};  // level of diagnostic_msgs
    std::string text;
  };
  struct Note {
    Timestamp time{};
    std::string text;
  };

  void drop_before(Timestamp time);
  Timestamp longest_silence() const;
  std::optional<Finding> silence(Timestamp now) const;
  std::optional<Finding> lost_second_images() const;
  std::vector<Finding> findings(Timestamp now) const;

  std::string topic_;   // constant after construction
  std::string second_;  // constant after construction
  Timestamp since_;     // constant after construction
  std::optional<Timestamp> last_arrival_;
  Timestamp interval_{};  // typical interval between images
  int arrived_ = 0;
  int skipped_ = 0;
  std::deque<Timestamp> skipped_times_;  // times within the last second
  std::deque<Recent> frames_;            // frames of the last second
  std::optional<Note> unusable_;
  std::optional<Note> jump_;
  std::optional<Note> frozen_;
  std::optional<Note> dropped_;
};

}  // namespace byre
