#pragma once

#include "byre/dds/participant.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// A node as it is told to other programs, for `ros2 node list` and `ros2 node info`.
struct NodeDescription {
  std::string name;              // "byre"
  std::string name_space = "/";  // begins with a slash
  std::vector<EntityId> readers{};
  std::vector<EntityId> writers{};
};

// The message of ros_discovery_info by which a program with one node tells of it, as programs of that distribution take
// it.
std::vector<std::byte> graph_message(const EntityId& participant, const NodeDescription& node,
                                     RosDistribution distribution);

// Tells others of the node as long as it lives.
class GraphAnnouncement {
 public:
  GraphAnnouncement(Participant& participant, NodeDescription node);

  // Endpoints that came after.
  void add(const Publisher& publisher);
  void add(const Subscriber& subscriber);
  void tell();

 private:
  EntityId participant_;          // constant after construction
  RosDistribution distribution_;  // constant after construction
  Publisher publisher_;
  NodeDescription node_;
};

}  // namespace byre
