#pragma once

#include "byre/assessment/event_log.h"
#include "byre/calibration.h"
#include "byre/playback/map_run.h"
#include "byre/ros/message_sink.h"

#include <chrono>
#include <optional>
#include <sstream>

namespace byre {

struct RunMessageOptions {
  bool with_images = false;  // images and camera info too
  // Whether the run is watched: path and map then come each second, but take a 500th of the run's time at most.
  bool is_watched = false;
};

// Tells what happens in a run as messages of ROS 2 that docs/bags.md lists: those that the sink wants.
class RunMessages {
 public:
  // Adds its topics. The sink outlives this.
  RunMessages(ros::MessageSink& sink, const Calibration& calibration, const RunMessageOptions& options);

  // One of both after each frame, in order.
  void note(const RunView& view);              // where its images could be read
  void note_unread(const MappedFrame& frame);  // where they could not

  void finish(const MapRun& run);  // after the last: the final path and map, whether they are wanted or not

 private:
  using TopicId = ros::MessageSink::TopicId;
  struct Topics {
    TopicId transforms, mounts, odometry, pose, path, diagnostics, events, points, offline_points;
  };
  struct CameraTopics {
    TopicId image, info;
  };

  CameraTopics add_camera(const std::string& name);
  void note_first(const RunView& view);
  void note_report(int number, const MappedFrame& frame);
  void note_diagnostics(int number, const MappedFrame& frame);
  void note_events(int number, const MappedFrame& frame);
  void note_pose(const FrameReport& report);
  void note_map(Timestamp time, const Map& online);
  void note_images(const ImageFrame& images);
  void note_image(const CameraTopics& topics, const Image& image, const Camera& camera, const char* frame,
                  Timestamp time);

  // Constant after construction.
  Calibration calibration_;
  ros::MessageSink& sink_;
  bool is_watched_;
  Topics topics_{};
  std::optional<CameraTopics> left_, right_;  // where images are told

  std::ostringstream event_text_;
  EventLog events_{event_text_};
  std::optional<StampedPose> odometry_;  // pose of the last frame that had one
  Trajectory path_;                      // poses that were believed, some way apart
  int frames_ = 0;
  std::optional<Timestamp> map_time_;                  // time of the frame when path and map were last told
  std::chrono::steady_clock::time_point map_pause_{};  // time until which they are not told again
  bool has_begun_ = false;
  Timestamp last_time_{};
};

}  // namespace byre
