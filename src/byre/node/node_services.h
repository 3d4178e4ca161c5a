#pragma once

#include "byre/dds/service_server.h"
#include "byre/node/node_config.h"
#include "byre/node/node_log.h"
#include "byre/ros/messages.h"
#include "byre/trajectory.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// What a service asks of a node: a command, as on the topic of commands, or where the robot is, as somebody says.
struct ServiceCall {
  std::string command{};
  std::optional<ros::PoseWithCovarianceStamped> hint{};
};

// Whether what was asked for was done, and what there is to say to that.
struct Outcome {
  bool is_done = false;
  std::string answer{};
};

// The commands of a node as services of ROS, docs/ros2.md.
class NodeServices {
 public:
  // log: is told where a service is called in words that it does not understand.
  NodeServices(const NodeConfig& config, Participant& participant, GraphAnnouncement& graph, NodeLog log);

  using Act = std::function<Outcome(const ServiceCall& call)>;
  // Has done what was asked for since it was asked last. now: of a clock that never goes back.
  void answer(const Act& act, Timestamp now);

 private:
  struct Service {
    std::string name;
    ServiceServer server;
    // The reply's bytes; empty where the request's are none of this service.
    std::function<std::optional<std::vector<std::byte>>(const Message& request, const Act& act)> reply_to;
    bool was_misunderstood = false;  // a request, which was told
  };

  template <typename Kind>
  void offer(const std::string& name, std::function<ServiceCall(const typename Kind::Request&)> call_of,
             std::function<typename Kind::Response(const Outcome&)> response_of);

  NodeConfig config_;         // constant after construction
  Participant& participant_;  // outlives this
  GraphAnnouncement& graph_;  // outlives this
  NodeLog log_;               // constant after construction
  std::vector<Service> services_;
};

}  // namespace byre
