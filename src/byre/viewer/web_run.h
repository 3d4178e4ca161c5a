#pragma once

#include "byre/calibration.h"
#include "byre/floor_plan.h"
#include "byre/map/plan_registration.h"
#include "byre/viewer/run_mailbox.h"
#include "byre/viewer/web_server.h"

#include <chrono>
#include <memory>
#include <optional>
#include <string>

namespace byre {

// What is known of a run before its first frame.
struct RunDescription {
  std::string name;                          // name of the recording
  Calibration calibration;                   // calibration of the recording's cameras
  int frames = 0;                            // frames in the recording
  Timestamp last_time{};                     // time of the recording's last frame
  std::string map_name;                      // name of the offline map, empty without one
  MapScene offline;                          // points and keyframes of the offline map
  std::optional<Eigen::Vector3d> up_in_map;  // unit length, where the offline map tells
  std::optional<FloorPlan> plan;
  std::optional<PlanRegistration> registration;  // registration of the offline map on a plan
};

struct RunViewerOptions {
  WebServerOptions server;
  std::size_t max_image_bytes = 200'000'000;     // kept to scrub through; older images are thinned out
  int jpeg_quality = 80;                         // percent
  std::chrono::milliseconds map_interval{1000};  // least time between copies of the online map, see RunViewer
};

// Shows a run in a browser while it goes on, and afterwards as long as it lives. The run's thread only copies: the left
// image and the points seen in it after each frame, the online map now and then. Rectifying, compressing and sending is
// done by the viewer's thread, which leaves images out when they come too fast, but no report.
class RunViewer {
 public:
  // Throws InputError as WebServer does, when the plan's image cannot be read, and when the calibration cannot be
  // rectified.
  RunViewer(RunDescription description, const RunViewerOptions& options);

  const std::vector<std::string>& urls() const { return server_.urls(); }

  // Call it after each frame, from the thread that runs the session.
  void show(const Image& recorded_left, const FrameReport& report, const Session& session);

  // Where messages of the run go for those who watch by Foxglove's protocol. Put what is known of a frame there before
  // it is shown.
  ros::MessageSink& messages() { return *topics_; }

  // No more frames will come.
  void end_run();

 private:
  void hand_over_map(const Map& online);

  // Constant after construction.
  std::chrono::milliseconds map_interval_;
  Timestamp last_time_;
  std::shared_ptr<RunMailbox> mailbox_;
  std::shared_ptr<LiveTopics> topics_;
  WebServer server_;

  // Owned by the calling thread.
  std::chrono::steady_clock::time_point next_map_{};  // time when a copy of the online map is due
};

}  // namespace byre
