#include "byre/ros2/dds/ros_graph.h"

#include "byre/ros2/dds/ros_network.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

// Messages of rmw_dds_common. Ids have 24 bytes up to Humble, the last 8 of them zero, and 16 bytes from Iron on.
template <std::size_t length>
struct Gid {
  std::array<std::uint8_t, length> data{};
  static void fields(auto& self, auto& visit) { visit("data", self.data); }
};

template <std::size_t length>
struct NodeEntitiesInfo {
  std::string node_namespace{};
  std::string node_name{};
  std::vector<Gid<length>> reader_gid_seq{};
  std::vector<Gid<length>> writer_gid_seq{};
  static void fields(auto& self, auto& visit) {
    visit("node_namespace node_name reader_gid_seq writer_gid_seq", self.node_namespace, self.node_name,
          self.reader_gid_seq, self.writer_gid_seq);
  }
};

template <std::size_t length>
struct ParticipantEntitiesInfo {
  static constexpr std::string_view kType = "rmw_dds_common/msg/ParticipantEntitiesInfo";
  Gid<length> gid{};
  std::vector<NodeEntitiesInfo<length>> node_entities_info_seq{};
  static void fields(auto& self, auto& visit) {
    visit("gid node_entities_info_seq", self.gid, self.node_entities_info_seq);
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

// User data by which a client matches the two endpoints of a server.
std::string service_note(EntityId id, const std::string& service) {
  // The last four bytes distinguish the endpoints of a participant; here they distinguish its services.
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const char letter : service) hash = (hash ^ static_cast<std::uint8_t>(letter)) * 16777619U;
  for (std::size_t i = 0; i < sizeof hash; ++i) id[id.size() - 1 - i] = static_cast<std::uint8_t>(hash >> (8 * i));
  return fmt::format("serviceid={:x};", fmt::join(id, "."));
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

ServiceServer::ServiceServer(GraphAnnouncement& graph, const std::string& service, const std::string& type) {
  const std::string note = service_note(graph.participant().id(), service);
  requests_ =
      graph.subscribe(dds_request_name(service), {type + "_Request", ""}, {.max_bytes = kMaxBytesWithoutImage}, note);
  replies_ = graph.publish(dds_reply_name(service), {type + "_Response", ""}, {}, note);
}

void ServiceServer::reply(std::vector<std::byte> message, std::chrono::nanoseconds now) {
  constexpr std::chrono::milliseconds kPatience(100);  // timeout of rmw_cyclonedds servers
  waiting_.push_back({std::move(message), now + kPatience});
  send_waiting(now);
}

void ServiceServer::send_waiting(std::chrono::nanoseconds now) {
  if (waiting_.empty()) return;
  const bool all_hear = replies_.subscribers() >= requests_.publishers();
  std::erase_if(waiting_, [&](Waiting& waiting) {
    if (!all_hear && now < waiting.until) return false;
    replies_.publish(std::move(waiting.message));
    return true;
  });
}

}  // namespace byre
