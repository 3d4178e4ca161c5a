#include "byre/ros2/node/parameters.h"

#include "byre/base/printable.h"
#include "byre/base/text_file.h"

#include <algorithm>
#include <string_view>

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

}  // namespace

ros::ListParameters::Response parameter_names(const ros::ListParameters::Request& request) {
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
  return {result};
}

ros::GetParameters::Response parameter_values(const NodeConfig& config, const ros::GetParameters::Request& request) {
  ros::GetParameters::Response response;
  for (const std::string& name : request.names) response.values.push_back(value_of(name, config));
  return response;
}

ros::GetParameterTypes::Response parameter_types(const NodeConfig& config,
                                                 const ros::GetParameterTypes::Request& request) {
  ros::GetParameterTypes::Response response;
  for (const std::string& name : request.names) response.types.push_back(value_of(name, config).type);
  return response;
}

ros::DescribeParameters::Response parameter_descriptions(const NodeConfig& config,
                                                         const ros::DescribeParameters::Request& request) {
  ros::DescribeParameters::Response response;
  for (const std::string& name : request.names) {
    ros::ParameterDescriptor descriptor;
    descriptor.name = name;
    if (const NodeSetting* const setting = setting_of(name)) {
      descriptor.type = value_of(*setting, config).type;
      descriptor.description = setting->meaning;
      descriptor.additional_constraints = setting->range;
      descriptor.read_only = true;
    }
    response.descriptors.push_back(descriptor);
  }
  return response;
}

ros::SetParameters::Response refused_parameters(const ros::SetParameters::Request& request) {
  ros::SetParameters::Response response;
  for (const ros::Parameter& parameter : request.parameters) response.results.push_back(refusal(parameter));
  return response;
}

ros::SetParametersAtomically::Response refused_parameters(const ros::SetParametersAtomically::Request& request) {
  if (request.parameters.empty()) return {{true, ""}};
  return {refusal(request.parameters.front())};
}

}  // namespace byre
