#include "byre/ros2/node/node_services.h"

#include "byre/input_error.h"
#include "byre/io/ros/message_reader.h"
#include "byre/io/ros/message_writer.h"
#include "byre/io/ros/services.h"
#include "byre/ros2/node/parameters.h"

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

}  // namespace

template <typename Kind>
void NodeServices::add_service(
    const std::string& name,
    std::function<typename Kind::Response(const typename Kind::Request& request, const Act& act)> response_of) {
  const std::string whole = config_.topic(name);
  const auto reply_to = [=](const Message& message, const Act& act) -> std::optional<std::vector<std::byte>> {
    const auto request = whole_request<typename Kind::Request>(message, whole);
    if (!request) return std::nullopt;
    const ServiceMessage<typename Kind::Response> reply{request->call, response_of(request->body, act)};
    return ros::write_message(reply, ros::Encoding::cdr);
  };
  services_.push_back({whole, ServiceServer(graph_, whole, std::string(Kind::kType)), reply_to});
}

template <typename Kind>
void NodeServices::add_command(const std::string& name,
                               std::function<std::string(const typename Kind::Request&)> command_of) {
  add_service<Kind>(name, [command_of](const typename Kind::Request& request, const Act& act) {
    const Outcome outcome = act({command_of(request)});
    return typename Kind::Response{outcome.is_done, outcome.answer};
  });
}

void NodeServices::add_parameters() {
  add_service<ros::ListParameters>("list_parameters",
                                   [](const auto& request, const Act&) { return parameter_names(request); });
  add_service<ros::GetParameters>(
      "get_parameters", [this](const auto& request, const Act&) { return parameter_values(config_, request); });
  add_service<ros::GetParameterTypes>(
      "get_parameter_types", [this](const auto& request, const Act&) { return parameter_types(config_, request); });
  add_service<ros::DescribeParameters>("describe_parameters", [this](const auto& request, const Act&) {
    return parameter_descriptions(config_, request);
  });
  add_service<ros::SetParameters>("set_parameters",
                                  [](const auto& request, const Act&) { return refused_parameters(request); });
  // Clients of rclpy wait for all six.
  add_service<ros::SetParametersAtomically>(
      "set_parameters_atomically", [](const auto& request, const Act&) { return refused_parameters(request); });
}

NodeServices::NodeServices(const NodeConfig& config, GraphAnnouncement& graph, NodeLog log)
    : config_(config), graph_(graph), log_(std::move(log)) {
  using ros::LoadMap, ros::SetBool, ros::SetInitialPose, ros::Trigger;
  add_command<Trigger>("save", [](const Trigger::Request&) { return "save"; });
  add_command<Trigger>("update", [](const Trigger::Request&) { return "update"; });
  add_command<Trigger>("relocalise", [](const Trigger::Request&) { return "relocalise"; });
  add_command<SetBool>("pause_mapping", [](const SetBool::Request& request) {
    return request.data ? "pause mapping" : "resume mapping";
  });
  add_service<LoadMap>("load_map", [](const LoadMap::Request& request, const Act& act) {
    const Outcome outcome = act({"load " + request.map_url});
    return LoadMap::Response{{}, outcome.is_done ? LoadMap::kSuccess : LoadMap::kUndefinedFailure};
  });
  add_service<SetInitialPose>("set_initial_pose", [](const SetInitialPose::Request& request, const Act& act) {
    act({{}, request.pose});
    return SetInitialPose::Response{};
  });
  add_parameters();
}

void NodeServices::answer(const Act& act, Timestamp now) {
  for (Service& service : services_) {
    for (const Message& request : service.server.take()) {
      if (auto reply = service.reply_to(request, act)) {
        service.server.reply(std::move(*reply), now);
      } else if (!std::exchange(service.has_logged_invalid, true)) {
        log_(LogLevel::warning,
             service.name + " is called by another middleware than rmw_cyclonedds_cpp: send commands to " +
                 config_.topic(config_.command) + ", or start the caller with RMW_IMPLEMENTATION=rmw_cyclonedds_cpp");
      }
    }
    service.server.send_waiting(now);
  }
}

}  // namespace byre
