#pragma once

#include "byre/io/ros/messages.h"
#include "byre/io/ros/services.h"
#include "byre/ros2/dds/ros_graph.h"
#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/process.h"
#include "byre/trajectory.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

// Settings of a node as ROS parameters, all read-only. Answers have the order and length of the request; unknown
// parameters have the type kNotSet, as in rclpy.

namespace byre {

// Names below the prefixes, or all without a prefix, down to a depth, as in rclcpp.
ros::ListParametersResult parameter_names(const ros::ListParameters::Request& request);

using ParameterNames = std::vector<std::string>;
std::vector<ros::ParameterValue> parameter_values(const NodeConfig& config, const ParameterNames& names);
std::vector<std::uint8_t> parameter_types(const NodeConfig& config, const ParameterNames& names);
std::vector<ros::ParameterDescriptor> parameter_descriptions(const NodeConfig& config, const ParameterNames& names);

// Refusals with their reasons.
std::vector<ros::SetParametersResult> refused_parameters(const std::vector<ros::Parameter>& parameters);
ros::SetParametersResult refused_atomically(const std::vector<ros::Parameter>& parameters);

// Request of a service: a command as on the command topic, or a pose hint.
struct ServiceCall {
  std::string command{};
  std::optional<ros::PoseWithCovarianceStamped> hint{};
};

// Result of a request with a text.
struct Outcome {
  bool is_done = false;
  std::string answer{};
};

// Commands and parameters of a node as ROS services, docs/reference/ros2.md.
class NodeServices {
 public:
  // log: receives requests in an unknown encoding.
  NodeServices(const NodeConfig& config, GraphAnnouncement& graph, NodeLog log);
  NodeServices(const NodeServices&) = delete;
  NodeServices& operator=(const NodeServices&) = delete;

  using Act = std::function<Outcome(const ServiceCall& call)>;
  // Executes requests received since the previous call, and replies. now: of a monotonic clock.
  void answer(const Act& act, Timestamp now);

 private:
  struct Service {
    std::string name;
    ServiceServer server;
    // Bytes of the reply; empty if the request is not of this service's type.
    std::function<std::optional<std::vector<std::byte>>(const Message& request, const Act& act)> reply_to;
    bool has_logged_invalid = false;  // an invalid request was logged
  };

  template <typename Kind>
  void add_service(
      const std::string& name,
      std::function<typename Kind::Response(const typename Kind::Request& request, const Act& act)> response_of);
  // A command without arguments, or with those of the request.
  template <typename Kind>
  void add_command(const std::string& name, std::function<std::string(const typename Kind::Request&)> command_of);
  void add_parameters();

  NodeConfig config_;         // constant after construction
  GraphAnnouncement& graph_;  // outlives this
  NodeLog log_;               // constant after construction
  std::vector<Service> services_;
};

}  // namespace byre
