#pragma once

#include "byre/ros2/dds/participant.h"

#include <optional>
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

  // Adds endpoints made later.
  void add(const Publisher& publisher);
  void add(const Subscriber& subscriber);
  void publish();

 private:
  EntityId participant_;          // constant after construction
  RosDistribution distribution_;  // constant after construction
  Publisher publisher_;
  NodeDescription node_;
};

}  // namespace byre
