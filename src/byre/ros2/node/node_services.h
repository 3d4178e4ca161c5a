#pragma once

#include "byre/io/ros/messages.h"
#include "byre/ros2/dds/service_server.h"
#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/node_log.h"
#include "byre/trajectory.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

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

// Commands of a node as ROS services, docs/reference/ros2.md.
class NodeServices {
 public:
  // log: receives requests in an unknown encoding.
  NodeServices(const NodeConfig& config, GraphAnnouncement& graph, NodeLog log);

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
  void add_service(const std::string& name, std::function<ServiceCall(const typename Kind::Request&)> call_of,
                   std::function<typename Kind::Response(const Outcome&)> response_of);

  NodeConfig config_;         // constant after construction
  GraphAnnouncement& graph_;  // outlives this
  NodeLog log_;               // constant after construction
  std::vector<Service> services_;
};

}  // namespace byre
