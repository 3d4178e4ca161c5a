#pragma once

#include "byre/recording.h"
#include "fast_peer.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "ros2_messages.h"
#include "ros2_messagesPubSubTypes.h"

namespace byre::testing_ros2 {

// `byre node` on the loopback interface, started as by a service manager. The destructor kills it.
class NodeProcess {
 public:
  // variables: additional environment variables, as NAME=VALUE.
  NodeProcess(const std::filesystem::path& folder, const std::string& config, int domain,
              std::vector<std::string> variables = {});
  ~NodeProcess();
  NodeProcess(const NodeProcess&) = delete;
  NodeProcess& operator=(const NodeProcess&) = delete;

  int stop();  // by SIGTERM; the exit code, or -1 if it ended otherwise
  bool is_running() const;
  std::string stderr_output() const;               // output on stderr
  bool has_logged(const std::string& text) const;  // on stderr, within 20 s
  pid_t process() const { return process_; }

 private:
  std::filesystem::path folder_;
  pid_t process_ = -1;
};

// Sends a dummy message and waits for its acknowledgment: Cyclone DDS drops messages of a reliable writer before its
// first heartbeat.
template <typename Message>
bool send_acknowledged(eprosima::fastdds::dds::DataWriter* writer, Message message) {
  writer->write(&message);
  return writer->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(20, 0)) == ReturnCode_t::RETCODE_OK;
}

int free_port();

// A random domain, unlikely to be used by other tests on this machine.
int some_domain();

sensor_msgs::msg::Image image_message(const Image& image, Timestamp time, const std::string& frame);
// Depths in metres (32FC1).
sensor_msgs::msg::Image depth_message(const DepthImage& depth, double units_per_metre, Timestamp time,
                                      const std::string& frame);
builtin_interfaces::msg::Time ros_time(Timestamp time);
Timestamp time_of(const builtin_interfaces::msg::Time& time);
Eigen::Vector3d vector_of(const geometry_msgs::msg::Point& point);

// Sends the images of a recording like a camera driver.
class CameraFeed {
 public:
  // second: right or depth.
  explicit CameraFeed(FastPeer& peer, bool is_reliable = true, const std::string& second = "right");

  bool has_subscriber() const;
  bool send_acknowledged();  // settles both writers with dummy images
  void send(const ImageFrame& frame, Timestamp later = {}) {
    send_left(frame, later);
    if (frame.right) send_right(frame, later);
  }
  void send_left(const ImageFrame& frame, Timestamp later = {});
  void send_right(const ImageFrame& frame, Timestamp later = {});
  void send_left(sensor_msgs::msg::Image message);
  void send_depth(const ImageFrame& frame, double units_per_metre);

 private:
  eprosima::fastdds::dds::DataWriter* left_;
  eprosima::fastdds::dds::DataWriter* second_;
};

}  // namespace byre::testing_ros2
