#pragma once

#include "byre/frame_report.h"
#include "byre/input_error.h"
#include "byre/ros/messages.h"
#include "byre/trajectory.h"

#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// What a frame tells of the cameras.
struct CameraFrame {
  bool has_right = true;
  bool wants_right = true;
  bool is_frozen = false;  // whether the image is the one before, bit by bit
  double seconds = 0.0;    // from the image's arrival to the poses
  InputFault fault = InputFault::none;
  std::optional<Timestamp> nearest_right;  // where there is no right image: distance to the stamp of the nearest one
  std::optional<Timestamp> jump;           // how far the stamps jumped before it
};

// Looks at what comes from the cameras, and says what is wrong with it within a second. Times are of one clock that
// never goes back.
class CameraWatch {
 public:
  // topic: of the left images, for messages; now: the beginning.
  CameraWatch(std::string topic, Timestamp now) : topic_(std::move(topic)), since_(now) {}

  void note_arrival(Timestamp now);                            // a left image came
  void note_unusable(const InputError& fault, Timestamp now);  // an image or calibration that cannot be used
  void note_frame(const CameraFrame& frame, Timestamp now);
  void note_passed_over(int total, Timestamp now);  // images left out since the beginning, as newer ones were there

  ros::DiagnosticStatus status(Timestamp now) const;

  int arrived() const { return arrived_; }

 private:
  struct Recent {
    Timestamp time{};
    bool lacks_right = false;
    double seconds = 0.0;
    std::optional<Timestamp> nearest_right{};
  };
  struct Finding {
    std::byte level{};  // as diagnostics have it
    std::string text;
  };
  struct Note {
    Timestamp time{};
    std::string text;
  };

  void forget_before(Timestamp time);
  Timestamp longest_silence() const;
  std::optional<Finding> silence(Timestamp now) const;
  std::optional<Finding> lost_right_images() const;
  std::vector<Finding> findings(Timestamp now) const;

  std::string topic_;  // constant after construction
  Timestamp since_;    // constant after construction
  std::optional<Timestamp> last_arrival_;
  Timestamp interval_{};  // usual time between images
  int arrived_ = 0;
  int passed_over_ = 0;
  std::deque<Timestamp> passed_over_at_;  // times within the last second
  std::deque<Recent> frames_;             // frames of the last second
  std::optional<Note> unusable_;
  std::optional<Note> jump_;
  std::optional<Note> frozen_;
  std::optional<Note> dropped_;
};

}  // namespace byre
