#include "byre/ros2/dds/service_server.h"

#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

// User data by which a client matches the two endpoints of a server.
std::string service_note(EntityId id, const std::string& service) {
  // The last four bytes distinguish the endpoints of a participant; here they distinguish its services.
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const char letter : service) hash = (hash ^ static_cast<std::uint8_t>(letter)) * 16777619U;
  for (std::size_t i = 0; i < sizeof hash; ++i) id[id.size() - 1 - i] = static_cast<std::uint8_t>(hash >> (8 * i));
  return fmt::format("serviceid={:x};", fmt::join(id, "."));
}

}  // namespace

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
