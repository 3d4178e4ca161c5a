#include "byre/ros2/node/node_services.h"

#include "byre/base/printable.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/ros/message_bytes.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace byre {
namespace {

constexpr char kSeparator = '.';

const NodeSetting* setting_of(std::string_view name) {
  const auto found = std::ranges::find(node_settings(), name, &NodeSetting::name);
  return found == node_settings().end() ? nullptr : &*found;
}

// An empty number is an empty text, which parameter files accept for it.
ros::ParameterValue value_of(const NodeSetting& setting, const NodeConfig& config) {
  ros::ParameterValue value;
  const std::string text = setting.get(config);
  const auto number = parse_number(text);
  if (setting.type == SettingType::boolean) {
    value.type = ros::ParameterValue::kBool;
    value.bool_value = text == "true";
  } else if (setting.type == SettingType::integer && number) {
    value.type = ros::ParameterValue::kInteger;
    value.integer_value = static_cast<std::int64_t>(*number);
  } else if (setting.type == SettingType::number && number) {
    value.type = ros::ParameterValue::kDouble;
    value.double_value = *number;
  } else {
    value.type = ros::ParameterValue::kString;
    value.string_value = text;
  }
  return value;
}

ros::ParameterValue value_of(const std::string& name, const NodeConfig& config) {
  const NodeSetting* const setting = setting_of(name);
  return setting == nullptr ? ros::ParameterValue() : value_of(*setting, config);
}

bool is_within(std::string_view name, std::uint64_t depth) {
  return depth == ros::ListParameters::kRecursive ||
         static_cast<std::uint64_t>(std::ranges::count(name, kSeparator)) < depth;
}

bool is_below(std::string_view name, std::string_view prefix, std::uint64_t depth) {
  if (name == prefix) return true;
  if (!name.starts_with(prefix) || name[prefix.size()] != kSeparator) return false;
  return is_within(name.substr(prefix.size() + 1), depth);
}

ros::SetParametersResult refusal(const ros::Parameter& parameter) {
  constexpr std::size_t kShownOfName = 100;
  if (setting_of(parameter.name) == nullptr) {
    return {false, "unknown parameter " + printable(parameter.name, kShownOfName)};
  }
  return {false, parameter.name + " is read-only; change the settings file or the arguments, and restart the node"};
}

// Parses a request that must use all bytes: requests of other DDS vendors lack the id and could be mistaken for another
// one.
template <typename Body>
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

ros::ListParametersResult parameter_names(const ros::ListParameters::Request& request) {
  ros::ListParametersResult result;
  for (const NodeSetting& setting : node_settings()) {
    const std::string& name = setting.name;
    const bool is_listed = request.prefixes.empty() ? is_within(name, request.depth)
                                                    : std::ranges::any_of(request.prefixes, [&](const auto& prefix) {
                                                        return is_below(name, prefix, request.depth);
                                                      });
    if (!is_listed) continue;
    result.names.push_back(name);
    const std::string group = name.substr(0, name.rfind(kSeparator));
    if (result.prefixes.empty() || result.prefixes.back() != group) result.prefixes.push_back(group);
  }
  return result;
}

std::vector<ros::ParameterValue> parameter_values(const NodeConfig& config, const ParameterNames& names) {
  std::vector<ros::ParameterValue> values;
  for (const std::string& name : names) values.push_back(value_of(name, config));
  return values;
}

std::vector<std::uint8_t> parameter_types(const NodeConfig& config, const ParameterNames& names) {
  std::vector<std::uint8_t> types;
  for (const std::string& name : names) types.push_back(value_of(name, config).type);
  return types;
}

std::vector<ros::ParameterDescriptor> parameter_descriptions(const NodeConfig& config, const ParameterNames& names) {
  std::vector<ros::ParameterDescriptor> descriptors;
  for (const std::string& name : names) {
    ros::ParameterDescriptor descriptor;
    descriptor.name = name;
    if (const NodeSetting* const setting = setting_of(name)) {
      descriptor.type = value_of(*setting, config).type;
      descriptor.description = setting->meaning;
      descriptor.additional_constraints = setting->range;
      descriptor.read_only = true;
    }
    descriptors.push_back(descriptor);
  }
  return descriptors;
}

std::vector<ros::SetParametersResult> refused_parameters(const std::vector<ros::Parameter>& parameters) {
  std::vector<ros::SetParametersResult> results;
  for (const ros::Parameter& parameter : parameters) results.push_back(refusal(parameter));
  return results;
}

ros::SetParametersResult refused_atomically(const std::vector<ros::Parameter>& parameters) {
  return parameters.empty() ? ros::SetParametersResult{true, ""} : refusal(parameters.front());
}

template <typename Kind>
void NodeServices::add_service(
    const std::string& name,
    std::function<typename Kind::Response(const typename Kind::Request& request, const Act& act)> response_of) {
  const std::string whole = config_.topic(name);
  const auto reply_to = [=](const Message& message, const Act& act) -> std::optional<std::vector<std::byte>> {
    const auto request = whole_request<typename Kind::Request>(message, whole);
    if (!request) return std::nullopt;
    const ServiceMessage<typename Kind::Response> reply{request->client, request->sequence,
                                                        response_of(request->body, act)};
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
      "set_parameters_atomically", [](const auto& request, const Act&) { return refused_atomically(request); });
}

NodeServices::NodeServices(const NodeConfig& config, GraphAnnouncement& graph, NodeLog log)
    : config_(config), graph_(graph), log_(std::move(log)) {
  using ros::LoadMap, ros::SetBool, ros::SetInitialPose, ros::Trigger;
  add_command<Trigger>("save", [](const Trigger::Request&) { return "save"; });
  add_command<Trigger>("update", [](const Trigger::Request&) { return "update"; });
  add_command<Trigger>("relocalise", [](const Trigger::Request&) { return "relocalise"; });
  add_command<SetBool>("pause_mapping",
                       [](const SetBool::Request& request) { return request ? "pause mapping" : "resume mapping"; });
  add_service<LoadMap>("load_map", [](const LoadMap::Request& request, const Act& act) {
    const Outcome outcome = act({"load " + request});
    return LoadMap::Response{{}, outcome.is_done ? LoadMap::kSuccess : LoadMap::kUndefinedFailure};
  });
  add_service<SetInitialPose>("set_initial_pose", [](const SetInitialPose::Request& request, const Act& act) {
    act({{}, request});
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
