#include "node_scene.h"

#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <boost/asio/ip/tcp.hpp>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace byre::testing_ros2 {

namespace fs = std::filesystem;
using eprosima::fastdds::dds::TypeSupport;

NodeProcess::NodeProcess(const fs::path& folder, const std::string& config, int domain,
                         std::vector<std::string> variables)
    : folder_(folder) {
  std::ofstream(folder / "robot.yaml") << config;
  const std::string path = (folder / "robot.yaml").string();
  variables.emplace_back("ROS_LOCALHOST_ONLY=1");
  variables.push_back("ROS_DOMAIN_ID=" + std::to_string(domain));
  std::vector<char*> environment;
  for (std::string& variable : variables) environment.push_back(variable.data());
  for (char** other = environ; *other != nullptr; ++other) {
    const std::string_view text(*other);
    if (!text.starts_with("ROS_")) environment.push_back(*other);
  }
  environment.push_back(nullptr);
  const char* const arguments[] = {BYRE_PROGRAM, "node", "--config", path.c_str(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 2, (folder / "said.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int error =
      posix_spawn(&process_, BYRE_PROGRAM, &files, nullptr, const_cast<char* const*>(arguments), environment.data());
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw std::runtime_error("byre node cannot be started");
}

NodeProcess::~NodeProcess() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

int NodeProcess::stop() {
  kill(process_, SIGTERM);
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool NodeProcess::is_running() const {
  return process_ > 0 && kill(process_, 0) == 0 && waitpid(process_, nullptr, WNOHANG) == 0;
}

std::string NodeProcess::stderr_output() const {
  std::ostringstream text;
  text << std::ifstream(folder_ / "said.txt").rdbuf();
  return text.str();
}

bool NodeProcess::has_logged(const std::string& text) const {
  for (int i = 0; i < 200; ++i) {
    if (stderr_output().find(text) != std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return false;
}

int free_port() {
  using boost::asio::ip::tcp;
  boost::asio::io_context context;
  const tcp::acceptor acceptor(context, {boost::asio::ip::make_address("127.0.0.1"), 0});
  return acceptor.local_endpoint().port();
}

int some_domain() {
  static int asked = 0;
  return 20 + (static_cast<int>(getpid()) + 7 * asked++) % 80;
}

builtin_interfaces::msg::Time ros_time(Timestamp time) {
  builtin_interfaces::msg::Time stamp;
  stamp.sec(static_cast<std::int32_t>(time.count() / 1'000'000'000));
  stamp.nanosec(static_cast<std::uint32_t>(time.count() % 1'000'000'000));
  return stamp;
}

Timestamp time_of(const builtin_interfaces::msg::Time& time) {
  return std::chrono::seconds(time.sec()) + std::chrono::nanoseconds(time.nanosec());
}

Eigen::Vector3d vector_of(const geometry_msgs::msg::Point& point) {
  return {point.x(), point.y(), point.z()};
}

sensor_msgs::msg::Image image_message(const Image& image, Timestamp time, const std::string& frame) {
  sensor_msgs::msg::Image message;
  message.header().stamp(ros_time(time));
  message.header().frame_id(frame);
  message.width(static_cast<std::uint32_t>(image.width));
  message.height(static_cast<std::uint32_t>(image.height));
  message.step(static_cast<std::uint32_t>(image.width));
  message.encoding("mono8");
  message.data(image.pixels);
  return message;
}

sensor_msgs::msg::Image depth_message(const DepthImage& depth, double units_per_metre, Timestamp time,
                                      const std::string& frame) {
  std::vector<float> metres;
  metres.reserve(depth.units.size());
  for (const std::uint16_t units : depth.units) metres.push_back(static_cast<float>(units / units_per_metre));
  sensor_msgs::msg::Image message = image_message({depth.width, depth.height, {}}, time, frame);
  message.encoding("32FC1");
  message.step(message.width() * static_cast<std::uint32_t>(sizeof(float)));
  message.data().resize(metres.size() * sizeof(float));
  std::memcpy(message.data().data(), metres.data(), message.data().size());
  return message;
}

CameraFeed::CameraFeed(FastPeer& peer, bool is_reliable, const std::string& second) {
  const PeerQos qos{is_reliable, false, 5};
  const auto type = [] { return TypeSupport(new sensor_msgs::msg::ImagePubSubType); };
  left_ = peer.writer("rt/left/image_raw", type(), qos);
  second_ = peer.writer("rt/" + second + "/image_raw", type(), qos);
}

bool CameraFeed::has_subscriber() const {
  return FastPeer::has_subscriber(left_) && FastPeer::has_subscriber(second_);
}

bool CameraFeed::send_acknowledged() {
  sensor_msgs::msg::Image image = image_message({1, 1, {0}}, {}, "left_optical");
  image.encoding("none");
  return testing_ros2::send_acknowledged(left_, image) && testing_ros2::send_acknowledged(second_, image);
}

void CameraFeed::send_left(const ImageFrame& frame, Timestamp later) {
  send_left(image_message(frame.left, frame.time + later, "left_optical"));
}

void CameraFeed::send_left(sensor_msgs::msg::Image message) {
  left_->write(&message);
}

void CameraFeed::send_right(const ImageFrame& frame, Timestamp later) {
  sensor_msgs::msg::Image message = image_message(*frame.right, frame.time + later, "right_optical");
  second_->write(&message);
}

void CameraFeed::send_depth(const ImageFrame& frame, double units_per_metre) {
  sensor_msgs::msg::Image message = depth_message(*frame.depth, units_per_metre, frame.time, "left_optical");
  second_->write(&message);
}

}  // namespace byre::testing_ros2
