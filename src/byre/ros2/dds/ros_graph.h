#pragma once

#include "byre/io/ros/message_bytes.h"
#include "byre/ros2/dds/participant.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace byre {

// Node for `ros2 node list` and `ros2 node info`.
struct NodeDescription {
  std::string name;              // such as "byre"
  std::string name_space = "/";  // begins with a slash
  std::vector<EntityId> readers{};
  std::vector<EntityId> writers{};
};

// Message on ros_discovery_info of a process with one node, in the encoding of a distribution.
std::vector<std::byte> graph_message(const EntityId& participant, const NodeDescription& node,
                                     RosDistribution distribution);

// Announces the node for its own lifetime.
class GraphAnnouncement {
 public:
  GraphAnnouncement(Participant& participant, NodeDescription node);

  // Endpoints of the node, as of Participant. The next announce() publishes them in the graph.
  Publisher publish(const std::string& topic, const MessageType& type, const TopicQos& qos,
                    const std::string& note = {});
  Subscriber subscribe(const std::string& topic, const MessageType& type, const TopicQos& qos,
                       const std::string& note = {});
  void announce();
  Participant& participant() { return participant_; }

 private:
  Participant& participant_;  // outlives this
  Publisher publisher_;
  NodeDescription node_;
};

// Request or reply on the wire. Body: a request or response of io/ros/services.h.
template <typename Body>
struct ServiceMessage {
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  Body body{};
  static void fields(auto& self, auto& visit) { visit("client sequence body", self.client, self.sequence, self.body); }
};

// ROS 2 service in the protocol of rmw_cyclonedds_cpp. Incompatible with other DDS vendors, which transfer the client
// id outside of the message.
class ServiceServer {
 public:
  // service: begins with a slash; type: "std_srvs/srv/Trigger". Both endpoints are added to the graph.
  ServiceServer(GraphAnnouncement& graph, const std::string& service, const std::string& type);

  // Requests since the previous call, oldest first, each a ServiceMessage.
  std::vector<Message> take() { return requests_.take(); }

  // Sends a reply, a ServiceMessage, once the client's reader is discovered, as DDS would lose it before. now: of a
  // monotonic clock.
  void reply(std::vector<std::byte> message, std::chrono::nanoseconds now);
  // Sends delayed replies; call it periodically.
  void send_waiting(std::chrono::nanoseconds now);

 private:
  struct Waiting {
    std::vector<std::byte> message;
    std::chrono::nanoseconds until{};
  };

  Subscriber requests_;
  Publisher replies_;
  std::vector<Waiting> waiting_;
};

}  // namespace byre
