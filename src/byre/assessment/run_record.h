#pragma once

#include "byre/assessment/event_log.h"
#include "byre/bag/mcap_writer.h"
#include "byre/calibration.h"
#include "byre/playback/map_run.h"

#include <cstdint>
#include <optional>
#include <sstream>

namespace byre {

// Writes what happens in a run into an MCAP file, as messages of ROS 2 that docs/bags.md lists. All throw InputError
// when the file cannot be written; what was written before can be read.
class RunRecord {
 public:
  // with_images: images and camera info too, so that the file can be run again.
  RunRecord(McapWriter writer, const Calibration& calibration, bool with_images);

  RunRecord(const RunRecord&) = delete;
  RunRecord& operator=(const RunRecord&) = delete;

  // One of both after each frame, in order.
  void note(const RunView& view);              // where its images could be read
  void note_unread(const MappedFrame& frame);  // where they could not

  void finish(const MapRun& run);  // after the last: the final path and map

 private:
  struct Topics {
    std::uint16_t transforms, mounts, odometry, pose, path, diagnostics, events, points, offline_points;
  };
  struct CameraTopics {
    std::uint16_t image, info;
  };

  CameraTopics add_camera(const std::string& name);
  void note_first(const RunView& view);
  void note_report(int number, const MappedFrame& frame);
  void note_images(const ImageFrame& images);
  void write_image(const CameraTopics& camera, const Image& image, const char* frame, Timestamp time);

  Calibration calibration_;  // constant after construction
  McapWriter writer_;
  Topics topics_;
  std::optional<CameraTopics> left_, right_;  // where images are recorded
  std::ostringstream event_text_;
  EventLog events_{event_text_};
  std::optional<StampedPose> odometry_;  // pose of the last frame that had one
  Trajectory path_;                      // poses that were believed, some way apart
  int frames_ = 0;
  std::optional<Timestamp> map_time_, flush_time_;  // when map and file were last brought up to date
  Timestamp last_time_{};
};

}  // namespace byre
