#pragma once

#include "byre/io/ros/messages.h"

#include <cstdint>
#include <string>
#include <string_view>

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

}  // namespace byre::ros
