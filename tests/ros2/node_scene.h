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

// `byre node` as a service manager starts it, on the loopback interface; killed with this if it is still there.
class NodeProcess {
 public:
  // variables: of its environment, as NAME=VALUE, beside those of this program.
  NodeProcess(const std::filesystem::path& folder, const std::string& config, int domain,
              std::vector<std::string> variables = {});
  ~NodeProcess();
  NodeProcess(const NodeProcess&) = delete;
  NodeProcess& operator=(const NodeProcess&) = delete;

  int stop();  // by SIGTERM; the exit code, or -1 when it ended otherwise
  bool is_running() const;
  std::string said() const;  // on the standard error stream
  pid_t process() const { return process_; }

 private:
  std::filesystem::path folder_;
  pid_t process_ = -1;
};

// Cyclone DDS leaves out what a reliable writer sends before its first heartbeat is in. Sends a message of no use, and
// waits until it is acknowledged.
template <typename Message>
bool settle(eprosima::fastdds::dds::DataWriter* writer, Message message) {
  writer->write(&message);
  return writer->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(20, 0)) == ReturnCode_t::RETCODE_OK;
}

// A port of TCP that nobody listens at.
int free_port();

// A domain that no other test of this machine has by chance.
int some_domain();

sensor_msgs::msg::Image image_message(const Image& image, Timestamp time, const std::string& frame);
builtin_interfaces::msg::Time ros_time(Timestamp time);
Timestamp time_of(const builtin_interfaces::msg::Time& time);
Eigen::Vector3d vector_of(const geometry_msgs::msg::Point& point);

// Sends the images of a stereo recording as a camera's driver does.
class CameraFeed {
 public:
  explicit CameraFeed(FastPeer& peer, bool is_reliable = true);

  bool is_heard() const;
  bool settle();  // both writers, by images of no use
  void send(const ImageFrame& frame, Timestamp later = {}) {
    send_left(frame, later);
    if (frame.right) send_right(frame, later);
  }
  void send_left(const ImageFrame& frame, Timestamp later = {});
  void send_right(const ImageFrame& frame, Timestamp later = {});
  void send_left(sensor_msgs::msg::Image message);

 private:
  eprosima::fastdds::dds::DataWriter* left_;
  eprosima::fastdds::dds::DataWriter* right_;
};

}  // namespace byre::testing_ros2
