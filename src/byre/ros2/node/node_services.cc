#include "byre/ros2/node/node_services.h"

#include "byre/input_error.h"
#include "byre/io/ros/message_reader.h"
#include "byre/io/ros/message_writer.h"
#include "byre/io/ros/services.h"

#include <utility>

namespace byre {
namespace {

// Parses a request that must use all bytes: requests of other DDS vendors lack the id and could be mistaken for another
// one.
template <ros::Message Body>
std::optional<ServiceMessage<Body>> whole_request(const Message& message, const std::string& service) {
  constexpr std::size_t kMaxPadding = 3;
  const std::span<const std::byte> bytes = message.bytes();
  try {
    const auto request = ros::read_message<ServiceMessage<Body>>(bytes, ros::Encoding::cdr, service);
    const std::size_t size = ros::write_message(request, ros::Encoding::cdr).size();
    return bytes.size() - size <= kMaxPadding ? std::optional(request) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

template <typename Response>
Response to_response(const Outcome& outcome) {
  return {outcome.is_done, outcome.answer};
}

template <typename Request>
std::function<ServiceCall(const Request&)> always(const std::string& command) {
  return [command](const Request&) { return ServiceCall{command}; };
}

}  // namespace

template <typename Kind>
void NodeServices::add_service(const std::string& name,
                               std::function<ServiceCall(const typename Kind::Request&)> call_of,
                               std::function<typename Kind::Response(const Outcome&)> response_of) {
  const std::string whole = config_.topic(name);
  const auto reply_to = [=](const Message& message, const Act& act) -> std::optional<std::vector<std::byte>> {
    const auto request = whole_request<typename Kind::Request>(message, whole);
    if (!request) return std::nullopt;
    const Outcome outcome = act(call_of(request->body));
    const ServiceMessage<typename Kind::Response> reply{request->call, response_of(outcome)};
    return ros::write_message(reply, ros::Encoding::cdr);
  };
  services_.push_back({whole, ServiceServer(graph_, whole, std::string(Kind::kType)), reply_to});
}

NodeServices::NodeServices(const NodeConfig& config, GraphAnnouncement& graph, NodeLog log)
    : config_(config), graph_(graph), log_(std::move(log)) {
  using ros::LoadMap, ros::SetBool, ros::SetInitialPose, ros::Trigger;
  add_service<Trigger>("save", always<Trigger::Request>("save"), to_response<Trigger::Response>);
  add_service<Trigger>("relocalise", always<Trigger::Request>("relocalise"), to_response<Trigger::Response>);
  add_service<SetBool>(
      "pause_mapping",
      [](const SetBool::Request& request) { return ServiceCall{request.data ? "pause mapping" : "resume mapping"}; },
      to_response<SetBool::Response>);
  add_service<LoadMap>(
      "load_map", [](const LoadMap::Request& request) { return ServiceCall{"load " + request.map_url}; },
      [](const Outcome& outcome) {
        return LoadMap::Response{{}, outcome.is_done ? LoadMap::kSuccess : LoadMap::kUndefinedFailure};
      });
  add_service<SetInitialPose>(
      "set_initial_pose",
      [](const SetInitialPose::Request& request) {
        return ServiceCall{{}, request.pose};
      },
      [](const Outcome&) { return SetInitialPose::Response{}; });
}

void NodeServices::answer(const Act& act, Timestamp now) {
  for (Service& service : services_) {
    for (const Message& request : service.server.take()) {
      if (auto reply = service.reply_to(request, act)) {
        service.server.reply(std::move(*reply), now);
      } else if (!std::exchange(service.has_logged_invalid, true)) {
        log_(LogLevel::warning, service.name +
                                    " is called by another middleware than rmw_cyclonedds_cpp: send commands to " +
                                    config_.topic(config_.command));
      }
    }
    service.server.send_waiting(now);
  }
}

}  // namespace byre
