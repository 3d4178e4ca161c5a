#include "byre/ros2/dds/ros_graph.h"

#include "byre/io/ros/message_writer.h"
#include "byre/ros2/dds/ros_names.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace byre {
namespace {

// Messages of rmw_dds_common. Ids have 24 bytes up to Humble, the last 8 of them zero, and 16 bytes from Iron on.
template <std::size_t length>
struct Gid {
  static constexpr std::string_view kType = "rmw_dds_common/msg/Gid";
  std::array<std::uint8_t, length> data{};
  static void fields(auto& self, auto& visit) { visit("data", self.data); }
};

template <std::size_t length>
struct NodeEntitiesInfo {
  static constexpr std::string_view kType = "rmw_dds_common/msg/NodeEntitiesInfo";
  std::string node_namespace{};
  std::string node_name{};
  std::vector<Gid<length>> reader_gid_seq{};
  std::vector<Gid<length>> writer_gid_seq{};
  static void fields(auto& self, auto& visit) {
    visit("node_namespace", self.node_namespace);
    visit("node_name", self.node_name);
    visit("reader_gid_seq", self.reader_gid_seq);
    visit("writer_gid_seq", self.writer_gid_seq);
  }
};

template <std::size_t length>
struct ParticipantEntitiesInfo {
  static constexpr std::string_view kType = "rmw_dds_common/msg/ParticipantEntitiesInfo";
  Gid<length> gid{};
  std::vector<NodeEntitiesInfo<length>> node_entities_info_seq{};
  static void fields(auto& self, auto& visit) {
    visit("gid", self.gid);
    visit("node_entities_info_seq", self.node_entities_info_seq);
  }
};

template <std::size_t length>
Gid<length> gid_of(const EntityId& id) {
  Gid<length> gid;
  std::ranges::copy(id, gid.data.begin());
  return gid;
}

template <std::size_t length>
std::vector<Gid<length>> gids_of(const std::vector<EntityId>& ids) {
  std::vector<Gid<length>> gids;
  for (const EntityId& id : ids) gids.push_back(gid_of<length>(id));
  return gids;
}

template <std::size_t length>
std::vector<std::byte> message_of(const EntityId& participant, const NodeDescription& node) {
  ParticipantEntitiesInfo<length> message;
  message.gid = gid_of<length>(participant);
  message.node_entities_info_seq.push_back(
      {node.name_space, node.name, gids_of<length>(node.readers), gids_of<length>(node.writers)});
  return ros::write_message(message, ros::Encoding::cdr);
}

}  // namespace

std::vector<std::byte> graph_message(const EntityId& participant, const NodeDescription& node,
                                     RosDistribution distribution) {
  return distribution == RosDistribution::humble ? message_of<24>(participant, node)
                                                 : message_of<16>(participant, node);
}

GraphAnnouncement::GraphAnnouncement(Participant& participant, NodeDescription node)
    : participant_(participant),
      publisher_(participant.publish("ros_discovery_info", message_type<ParticipantEntitiesInfo<16>>(),
                                     {.is_reliable = true, .is_latched = true, .depth = 1})),
      node_(std::move(node)) {}

Publisher GraphAnnouncement::publish(const std::string& topic, const MessageType& type, const TopicQos& qos,
                                     const std::string& note) {
  Publisher publisher = participant_.publish(topic, type, qos, note);
  node_.writers.push_back(publisher.id());
  return publisher;
}

Subscriber GraphAnnouncement::subscribe(const std::string& topic, const MessageType& type, const TopicQos& qos,
                                        const std::string& note) {
  Subscriber subscriber = participant_.subscribe(topic, type, qos, note);
  node_.readers.push_back(subscriber.id());
  return subscriber;
}

void GraphAnnouncement::announce() {
  publisher_.publish(graph_message(participant_.id(), node_, participant_.distribution()));
}

}  // namespace byre
