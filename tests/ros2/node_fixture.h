#pragma once

#include "byre/calibration_file.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/slam.h"
#include "node_scene.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

namespace byre::testing_ros2 {

namespace fs = std::filesystem;

using Odometry = Inbox<nav_msgs::msg::Odometry, nav_msgs::msg::OdometryPubSubType>;
using Poses =
    Inbox<geometry_msgs::msg::PoseWithCovarianceStamped, geometry_msgs::msg::PoseWithCovarianceStampedPubSubType>;
using Transforms = Inbox<tf2_msgs::msg::TFMessage, tf2_msgs::msg::TFMessagePubSubType>;
using Diagnostics = Inbox<diagnostic_msgs::msg::DiagnosticArray, diagnostic_msgs::msg::DiagnosticArrayPubSubType>;
using Texts = Inbox<std_msgs::msg::String, std_msgs::msg::StringPubSubType>;
using Clouds = Inbox<sensor_msgs::msg::PointCloud2, sensor_msgs::msg::PointCloud2PubSubType>;
using Grids = Inbox<nav_msgs::msg::OccupancyGrid, nav_msgs::msg::OccupancyGridPubSubType>;
using Paths = Inbox<nav_msgs::msg::Path, nav_msgs::msg::PathPubSubType>;
using Graph =
    Inbox<rmw_dds_common::msg::ParticipantEntitiesInfo, rmw_dds_common::msg::ParticipantEntitiesInfoPubSubType>;
using eprosima::fastdds::dds::TypeSupport;

inline void send_text(eprosima::fastdds::dds::DataWriter* writer, const std::string& text) {
  std_msgs::msg::String message;
  message.data(text);
  writer->write(&message);
}

// Waits until node and peer have discovered each other. Endpoints are announced in order of creation: a node that
// answers a command has discovered the cameras' writers, and a peer that receives the answer gets all other messages.
inline bool have_discovered_each_other(CameraFeed& feed, Texts& events, eprosima::fastdds::dds::DataWriter* command) {
  if (!feed.has_subscriber()) return false;
  for (int attempt = 0; attempt < 100; ++attempt) {
    send_text(command, "hello");
    if (events.find([](const auto& event) { return event.data().find("hello") != std::string::npos; },
                    std::chrono::seconds(1)))
      return feed.send_acknowledged();
  }
  return false;
}

inline constexpr PeerQos kVolatile{true, false, 100};
inline constexpr PeerQos kLatched{true, true, 100};

// A rendered room, the node's calibration, and a map of the room.
class Room {
 public:
  static const Room& shared() {
    static const Room room;
    return room;
  }

  fs::path calibration() const { return folder_ / "camchain.yaml"; }
  fs::path map() const { return folder_ / "room.byre"; }
  const std::vector<ImageFrame>& frames() const { return frames_; }
  // Content of the image's PNG file.
  std::vector<std::uint8_t> file(const std::string& camera, std::size_t frame) const {
    std::ifstream stream(rendered_.image(camera, frame), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  // Reports of a Slam instance on the frames, for comparison.
  std::vector<FrameReport> tracked(Slam slam) const {
    std::vector<FrameReport> reports;
    for (const ImageFrame& frame : frames_) reports.push_back(slam.process(view_of(frame)));
    return reports;
  }
  static SlamOptions options() {
    SlamOptions options;
    options.workers = Workers::repeatable;
    return options;
  }

 private:
  Room() {
    const auto recording = open_recording(rendered_.folder(), {});
    for (int i = 0; i < recording->size(); ++i) frames_.push_back(*recording->read(i));
    std::ofstream(calibration()) << write_calibration(recording->calibration());
    Slam slam = Slam::mapping(read_calibration(calibration()), options());
    for (const ImageFrame& frame : frames_) slam.process(view_of(frame));
    slam.finish();
    slam.save(map());
  }

  RenderedFixture rendered_{"byre_ros2_room", 40, 20.0};
  fs::path folder_ = rendered_.folder();
  std::vector<ImageFrame> frames_;
};

class ByreNode : public testing::Test {
 protected:
  ByreNode() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ByreNode() override { fs::remove_all(folder_); }

  static std::string config(const std::string& slam, const std::string& more = {}) {
    return "slam:\n  workers: repeatable\n" + slam + "images:\n  reliable: true\n  pair_wait: 0.2\n" +
           "calibration:\n  file: " + Room::shared().calibration().string() + "\n" + more;
  }
  std::string mapping() const { return config("  task: map\n  save: " + (folder_ / "made.byre").string() + "\n"); }
  static std::string mission(const std::string& more = {}) {
    return config("  map: " + Room::shared().map().string() + "\n", more);
  }

  bool is_connected() { return diagnostics_.first() && have_discovered_each_other(feed_, events_, command_); }
  void command(const std::string& text) { send_text(command_, text); }

  // Sends a frame and waits for its odometry message.
  std::optional<nav_msgs::msg::Odometry> answer_to(CameraFeed& feed, Odometry& odometry, const ImageFrame& frame,
                                                   Timestamp later = {}) const {
    feed.send(frame, later);
    return odometry.find([&](const auto& message) { return time_of(message.header().stamp()) == frame.time + later; });
  }

  // Message of a diagnostics status, once it contains part.
  static std::optional<std::string> diagnosis(Diagnostics& diagnostics, const std::string& name,
                                              const std::string& part) {
    std::optional<std::string> text;
    diagnostics.find([&](const diagnostic_msgs::msg::DiagnosticArray& message) {
      for (const auto& status : message.status()) {
        if (status.name() == name && status.message().find(part) != std::string::npos) text = status.message();
      }
      return text.has_value();
    });
    return text;
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_node." + std::to_string(getpid()));
  int domain_ = some_domain();
  FastPeer peer_{domain_};
  Odometry odometry_{peer_, "rt/byre/odometry", kVolatile};
  Diagnostics diagnostics_{peer_, "rt/diagnostics", kVolatile};
  Texts events_{peer_, "rt/byre/events", kVolatile};
  CameraFeed feed_{peer_};
  eprosima::fastdds::dds::DataWriter* command_ =
      peer_.writer("rt/byre/command", TypeSupport(new std_msgs::msg::StringPubSubType), kVolatile);
};

}  // namespace byre::testing_ros2
