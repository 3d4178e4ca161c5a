#pragma once

#include "byre/io/ros/messages.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// ROS services offered by byre. A request or response with one field has the type of the field.
namespace byre::ros {

// Empty requests and responses take a byte on the wire.
using Empty = std::uint8_t;

struct Trigger {
  static constexpr std::string_view kType = "std_srvs/srv/Trigger";
  using Request = Empty;
  struct Response {
    bool success = false;
    std::string message{};
    static void fields(auto& self, auto& visit) { visit("success message", self.success, self.message); }
  };
};

struct SetBool {
  static constexpr std::string_view kType = "std_srvs/srv/SetBool";
  using Request = bool;
  using Response = Trigger::Response;
};

struct SetInitialPose {
  static constexpr std::string_view kType = "nav2_msgs/srv/SetInitialPose";
  using Request = PoseWithCovarianceStamped;
  using Response = Empty;
};

struct LoadMap {
  static constexpr std::string_view kType = "nav2_msgs/srv/LoadMap";
  static constexpr std::uint8_t kSuccess = 0;
  static constexpr std::uint8_t kUndefinedFailure = 255;
  using Request = std::string;  // map_url
  struct Response {
    OccupancyGrid map{};
    std::uint8_t result = kSuccess;
    static void fields(auto& self, auto& visit) { visit("map result", self.map, self.result); }
  };
};

// Value of a parameter; type determines which field is set.
struct ParameterValue {
  static constexpr std::uint8_t kNotSet = 0, kBool = 1, kInteger = 2, kDouble = 3, kString = 4;
  std::uint8_t type = kNotSet;
  bool bool_value = false;
  std::int64_t integer_value = 0;
  double double_value = 0.0;
  std::string string_value{};
  std::vector<std::uint8_t> byte_array_value{};
  std::vector<std::uint8_t> bool_array_value{};
  std::vector<std::int64_t> integer_array_value{};
  std::vector<double> double_array_value{};
  std::vector<std::string> string_array_value{};
  static void fields(auto& self, auto& visit) {
    visit(
        "type bool_value integer_value double_value string_value byte_array_value bool_array_value integer_array_value "
        "double_array_value string_array_value",
        self.type, self.bool_value, self.integer_value, self.double_value, self.string_value, self.byte_array_value,
        self.bool_array_value, self.integer_array_value, self.double_array_value, self.string_array_value);
  }
};

struct Parameter {
  std::string name{};
  ParameterValue value{};
  static void fields(auto& self, auto& visit) { visit("name value", self.name, self.value); }
};

struct ParameterDescriptor {
  std::string name{};
  std::uint8_t type = ParameterValue::kNotSet;
  std::string description{};
  std::string additional_constraints{};
  bool read_only = false;
  bool dynamic_typing = false;
  std::vector<std::array<double, 3>> floating_point_range{};  // never sent
  std::vector<std::array<std::uint64_t, 3>> integer_range{};  // never sent
  static void fields(auto& self, auto& visit) {
    visit("name type description additional_constraints read_only dynamic_typing floating_point_range integer_range",
          self.name, self.type, self.description, self.additional_constraints, self.read_only, self.dynamic_typing,
          self.floating_point_range, self.integer_range);
  }
};

struct SetParametersResult {
  bool successful = false;
  std::string reason{};
  static void fields(auto& self, auto& visit) { visit("successful reason", self.successful, self.reason); }
};

struct ListParametersResult {
  std::vector<std::string> names{};
  std::vector<std::string> prefixes{};
  static void fields(auto& self, auto& visit) { visit("names prefixes", self.names, self.prefixes); }
};

struct ListParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/ListParameters";
  static constexpr std::uint64_t kRecursive = 0;
  struct Request {
    std::vector<std::string> prefixes{};
    std::uint64_t depth = kRecursive;
    static void fields(auto& self, auto& visit) { visit("prefixes depth", self.prefixes, self.depth); }
  };
  using Response = ListParametersResult;
};

struct GetParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameters";
  using Request = std::vector<std::string>;  // names
  using Response = std::vector<ParameterValue>;
};

struct GetParameterTypes {
  static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameterTypes";
  using Request = std::vector<std::string>;  // names
  using Response = std::vector<std::uint8_t>;
};

struct DescribeParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/DescribeParameters";
  using Request = std::vector<std::string>;  // names
  using Response = std::vector<ParameterDescriptor>;
};

struct SetParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/SetParameters";
  using Request = std::vector<Parameter>;
  using Response = std::vector<SetParametersResult>;
};

struct SetParametersAtomically {
  static constexpr std::string_view kType = "rcl_interfaces/srv/SetParametersAtomically";
  using Request = std::vector<Parameter>;
  using Response = SetParametersResult;
};

}  // namespace byre::ros
