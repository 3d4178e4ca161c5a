#pragma once

#include "byre/calibration.h"
#include "byre/io/ros/message_sink.h"
#include "byre/playback/play.h"
#include "byre/playback/report/event_log.h"
#include "byre/playback/report/ros_report.h"

#include <chrono>
#include <optional>
#include <sstream>

namespace byre {

struct RunMessageOptions {
  bool with_images = false;  // adds images and camera info
  // Whether a live viewer watches: path and map are then published every second, within 1/500 of the run's time.
  bool is_watched = false;
};

// Publishes a run as ROS 2 messages (docs/reference/recordings.md), limited to the topics that the sink wants.
class RunMessages {
 public:
  // Adds its topics to the sink, which must outlive it.
  RunMessages(ros::MessageSink& sink, const Calibration& calibration, const RunMessageOptions& options);

  // Call one of the two after each frame, in order.
  void note(const RunView& view);                  // frame with readable images
  void note_unreadable(const PlayedFrame& frame);  // frame without

  void finish(const RunResult& run);  // call after the last frame: publishes final path and map, wanted or not

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
  void note_report(int number, const PlayedFrame& frame);
  void note_diagnostics(int number, const PlayedFrame& frame);
  void note_events(int number, const PlayedFrame& frame);
  void note_pose(const FrameReport& report);
  void note_map(Timestamp time, const MapGraph& online);
  void note_images(const ImageFrame& images);
  void note_image(const CameraTopics& topics, const Image& image, const Camera& camera, const char* frame,
                  Timestamp time);

  // Constant after construction.
  Calibration calibration_;
  ros::MessageSink& sink_;
  bool is_watched_;
  Topics topics_{};
  std::optional<CameraTopics> left_, right_;  // only with images

  std::ostringstream event_text_;
  EventLog events_{event_text_};
  std::optional<OdometrySample> odometry_;  // previous frame; empty if it has no odometry
  Trajectory path_;                         // trusted or degraded poses at least kPathStep apart
  int frames_ = 0;
  std::optional<Timestamp> map_time_;                  // frame time of the last path and map message
  std::chrono::steady_clock::time_point map_pause_{};  // earliest time of the next one
  bool has_begun_ = false;
  Timestamp last_time_{};
};

}  // namespace byre
