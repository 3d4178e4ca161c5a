#pragma once

#include "byre/calibration.h"
#include "byre/floor_plan.h"
#include "byre/plan_registration.h"
#include "byre/viewer/scene.h"
#include "byre/viewer/web/web_server.h"

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Encoded images of a run by frame number, in bounded memory: when full, every second image of the older half is
// dropped.
class ImageStore {
 public:
  explicit ImageStore(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  void add(std::size_t frame, std::string bytes);

  // Image of the frame, else of the nearest stored frame; nullptr if empty.
  const std::string* find_nearest(std::size_t frame) const;

  std::size_t count() const { return images_.size(); }
  std::size_t bytes() const { return bytes_; }

 private:
  void thin_out();

  std::size_t max_bytes_;  // constant after construction
  std::map<std::size_t, std::string> images_;
  std::size_t bytes_ = 0;  // total size of all images
};

// Report of a frame, with the size of the online map at that time.
struct ShownFrame {
  FrameReport report;
  int online_keyframes = 0;
  int online_points = 0;
};

// Mailbox from the thread of a run to the viewer's thread; put() never waits. Reports accumulate; of images and maps
// only the newest is held. Thread-safe.
class RunMailbox {
 public:
  struct Content {
    std::vector<ShownFrame> frames;
    std::optional<FrameScene> newest;  // scene of the newest of these frames; the left image is not rectified
    std::optional<MapScene> online;
    bool has_ended = false;  // no more frames follow
  };

  void put(ShownFrame frame, FrameScene scene);
  void put(MapScene online);
  void put_end();

  // Removes and returns all content.
  Content take();

 private:
  std::mutex mutex_;
  Content content_;  // guarded by the mutex
};

// Description of a run before its first frame.
struct RunDescription {
  std::string name;
  Calibration calibration;
  int frames = 0;                            // frames in the recording
  Timestamp last_time{};                     // time of the recording's last frame
  std::string map_name;                      // name of the offline map; empty without one
  MapScene offline;                          // points and keyframes of the offline map
  std::optional<Eigen::Vector3d> up_in_map;  // unit vector; empty if the offline map does not provide it
  std::optional<FloorPlan> plan;
  std::optional<PlanRegistration> registration;  // registration of the offline map on a plan
};

struct RunViewerOptions {
  WebServerOptions server;
  std::size_t max_image_bytes = 200'000'000;     // memory for image history; older images are thinned out
  int jpeg_quality = 80;                         // percent
  std::chrono::milliseconds map_interval{1000};  // least time between copies of the online map, see RunViewer
};

// Shows a run in a browser, live and afterwards for its own lifetime. The run's thread only copies: left image and seen
// points of each frame, the online map at intervals. The viewer's thread rectifies, compresses and sends; it skips
// images if they come too fast, but no reports.
class RunViewer {
 public:
  // Throws InputError as WebServer does, and if the plan's image cannot be read or the calibration cannot be rectified.
  RunViewer(RunDescription description, const RunViewerOptions& options);

  const std::vector<std::string>& urls() const { return server_.urls(); }

  // Call it after each frame, from the session's thread.
  void show(const Image& recorded_left, const FrameReport& report, const Session& session);

  // Sink for messages to Foxglove clients. Put the messages of a frame before show().
  ros::MessageSink& messages() { return *topics_; }

  // No more frames follow.
  void end_run();

 private:
  void copy_map(const MapGraph& online);

  // Constant after construction.
  std::chrono::milliseconds map_interval_;
  Timestamp last_time_;
  std::shared_ptr<RunMailbox> mailbox_;
  std::shared_ptr<LiveTopics> topics_;
  WebServer server_;

  // Owned by the calling thread.
  std::chrono::steady_clock::time_point next_map_{};  // time of the next copy of the online map
};

}  // namespace byre
