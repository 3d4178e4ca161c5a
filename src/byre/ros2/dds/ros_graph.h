#pragma once

#include "byre/ros2/dds/participant.h"

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

}  // namespace byre
