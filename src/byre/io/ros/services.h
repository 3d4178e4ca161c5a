#pragma once

#include "byre/io/ros/messages.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// ROS services offered by byre, with request and response messages. Empty ones take a byte on the wire.
namespace byre::ros {

struct Trigger {
  static constexpr std::string_view kType = "std_srvs/srv/Trigger";
  struct Request {
    static constexpr std::string_view kType = "std_srvs/srv/Trigger_Request";
    std::uint8_t filler = 0;
    static void fields(auto& self, auto& visit) { visit("structure_needs_at_least_one_member", self.filler); }
  };
  struct Response {
    static constexpr std::string_view kType = "std_srvs/srv/Trigger_Response";
    bool success = false;
    std::string message{};
    static void fields(auto& self, auto& visit) {
      visit("success", self.success);
      visit("message", self.message);
    }
  };
};

struct SetBool {
  static constexpr std::string_view kType = "std_srvs/srv/SetBool";
  struct Request {
    static constexpr std::string_view kType = "std_srvs/srv/SetBool_Request";
    bool data = false;
    static void fields(auto& self, auto& visit) { visit("data", self.data); }
  };
  struct Response {
    static constexpr std::string_view kType = "std_srvs/srv/SetBool_Response";
    bool success = false;
    std::string message{};
    static void fields(auto& self, auto& visit) {
      visit("success", self.success);
      visit("message", self.message);
    }
  };
};

struct SetInitialPose {
  static constexpr std::string_view kType = "nav2_msgs/srv/SetInitialPose";
  struct Request {
    static constexpr std::string_view kType = "nav2_msgs/srv/SetInitialPose_Request";
    PoseWithCovarianceStamped pose{};
    static void fields(auto& self, auto& visit) { visit("pose", self.pose); }
  };
  struct Response {
    static constexpr std::string_view kType = "nav2_msgs/srv/SetInitialPose_Response";
    std::uint8_t filler = 0;
    static void fields(auto& self, auto& visit) { visit("structure_needs_at_least_one_member", self.filler); }
  };
};

struct LoadMap {
  static constexpr std::string_view kType = "nav2_msgs/srv/LoadMap";
  static constexpr std::uint8_t kSuccess = 0;
  static constexpr std::uint8_t kUndefinedFailure = 255;
  struct Request {
    static constexpr std::string_view kType = "nav2_msgs/srv/LoadMap_Request";
    std::string map_url{};
    static void fields(auto& self, auto& visit) { visit("map_url", self.map_url); }
  };
  struct Response {
    static constexpr std::string_view kType = "nav2_msgs/srv/LoadMap_Response";
    OccupancyGrid map{};
    std::uint8_t result = kSuccess;
    static void fields(auto& self, auto& visit) {
      visit("map", self.map);
      visit("result", self.result);
    }
  };
};

// Value of a parameter; type determines which field is set.
struct ParameterValue {
  static constexpr std::string_view kType = "rcl_interfaces/msg/ParameterValue";
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
    visit("type", self.type);
    visit("bool_value", self.bool_value);
    visit("integer_value", self.integer_value);
    visit("double_value", self.double_value);
    visit("string_value", self.string_value);
    visit("byte_array_value", self.byte_array_value);
    visit("bool_array_value", self.bool_array_value);
    visit("integer_array_value", self.integer_array_value);
    visit("double_array_value", self.double_array_value);
    visit("string_array_value", self.string_array_value);
  }
};

struct Parameter {
  static constexpr std::string_view kType = "rcl_interfaces/msg/Parameter";
  std::string name{};
  ParameterValue value{};
  static void fields(auto& self, auto& visit) {
    visit("name", self.name);
    visit("value", self.value);
  }
};

// Range of numbers; never sent.
template <typename Number, typename Step>
struct ParameterRange {
  static constexpr std::string_view kType =
      std::is_integral_v<Number> ? "rcl_interfaces/msg/IntegerRange" : "rcl_interfaces/msg/FloatingPointRange";
  Number from_value{};
  Number to_value{};
  Step step{};
  static void fields(auto& self, auto& visit) {
    visit("from_value", self.from_value);
    visit("to_value", self.to_value);
    visit("step", self.step);
  }
};

struct ParameterDescriptor {
  static constexpr std::string_view kType = "rcl_interfaces/msg/ParameterDescriptor";
  std::string name{};
  std::uint8_t type = ParameterValue::kNotSet;
  std::string description{};
  std::string additional_constraints{};
  bool read_only = false;
  bool dynamic_typing = false;
  std::vector<ParameterRange<double, double>> floating_point_range{};
  std::vector<ParameterRange<std::int64_t, std::uint64_t>> integer_range{};
  static void fields(auto& self, auto& visit) {
    visit("name", self.name);
    visit("type", self.type);
    visit("description", self.description);
    visit("additional_constraints", self.additional_constraints);
    visit("read_only", self.read_only);
    visit("dynamic_typing", self.dynamic_typing);
    visit("floating_point_range", self.floating_point_range);
    visit("integer_range", self.integer_range);
  }
};

struct SetParametersResult {
  static constexpr std::string_view kType = "rcl_interfaces/msg/SetParametersResult";
  bool successful = false;
  std::string reason{};
  static void fields(auto& self, auto& visit) {
    visit("successful", self.successful);
    visit("reason", self.reason);
  }
};

struct ListParametersResult {
  static constexpr std::string_view kType = "rcl_interfaces/msg/ListParametersResult";
  std::vector<std::string> names{};
  std::vector<std::string> prefixes{};
  static void fields(auto& self, auto& visit) {
    visit("names", self.names);
    visit("prefixes", self.prefixes);
  }
};

struct ListParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/ListParameters";
  static constexpr std::uint64_t kRecursive = 0;
  struct Request {
    static constexpr std::string_view kType = "rcl_interfaces/srv/ListParameters_Request";
    std::vector<std::string> prefixes{};
    std::uint64_t depth = kRecursive;
    static void fields(auto& self, auto& visit) {
      visit("prefixes", self.prefixes);
      visit("depth", self.depth);
    }
  };
  struct Response {
    static constexpr std::string_view kType = "rcl_interfaces/srv/ListParameters_Response";
    ListParametersResult result{};
    static void fields(auto& self, auto& visit) { visit("result", self.result); }
  };
};

struct GetParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameters";
  struct Request {
    static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameters_Request";
    std::vector<std::string> names{};
    static void fields(auto& self, auto& visit) { visit("names", self.names); }
  };
  struct Response {
    static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameters_Response";
    std::vector<ParameterValue> values{};
    static void fields(auto& self, auto& visit) { visit("values", self.values); }
  };
};

struct GetParameterTypes {
  static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameterTypes";
  struct Request {
    static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameterTypes_Request";
    std::vector<std::string> names{};
    static void fields(auto& self, auto& visit) { visit("names", self.names); }
  };
  struct Response {
    static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameterTypes_Response";
    std::vector<std::uint8_t> types{};
    static void fields(auto& self, auto& visit) { visit("types", self.types); }
  };
};

struct DescribeParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/DescribeParameters";
  struct Request {
    static constexpr std::string_view kType = "rcl_interfaces/srv/DescribeParameters_Request";
    std::vector<std::string> names{};
    static void fields(auto& self, auto& visit) { visit("names", self.names); }
  };
  struct Response {
    static constexpr std::string_view kType = "rcl_interfaces/srv/DescribeParameters_Response";
    std::vector<ParameterDescriptor> descriptors{};
    static void fields(auto& self, auto& visit) { visit("descriptors", self.descriptors); }
  };
};

struct SetParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/SetParameters";
  struct Request {
    static constexpr std::string_view kType = "rcl_interfaces/srv/SetParameters_Request";
    std::vector<Parameter> parameters{};
    static void fields(auto& self, auto& visit) { visit("parameters", self.parameters); }
  };
  struct Response {
    static constexpr std::string_view kType = "rcl_interfaces/srv/SetParameters_Response";
    std::vector<SetParametersResult> results{};
    static void fields(auto& self, auto& visit) { visit("results", self.results); }
  };
};

struct SetParametersAtomically {
  static constexpr std::string_view kType = "rcl_interfaces/srv/SetParametersAtomically";
  struct Request {
    static constexpr std::string_view kType = "rcl_interfaces/srv/SetParametersAtomically_Request";
    std::vector<Parameter> parameters{};
    static void fields(auto& self, auto& visit) { visit("parameters", self.parameters); }
  };
  struct Response {
    static constexpr std::string_view kType = "rcl_interfaces/srv/SetParametersAtomically_Response";
    SetParametersResult result{};
    static void fields(auto& self, auto& visit) { visit("result", self.result); }
  };
};

}  // namespace byre::ros
