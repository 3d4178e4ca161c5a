#pragma once

#include "byre/io/ros/message.h"
#include "byre/ros2/dds/participant.h"
#include "byre/ros2/dds/ros_graph.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Header of requests and replies: client and sequence number.
struct ServiceCallId {
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  static void fields(auto& self, auto& visit) {
    visit("client", self.client);
    visit("sequence", self.sequence);
  }
};

// Request or reply on the wire. Body: a struct of io/ros/services.h.
template <ros::Message Body>
struct ServiceMessage {
  static constexpr std::string_view kType = Body::kType;
  ServiceCallId call{};
  Body body{};
  static void fields(auto& self, auto& visit) {
    ServiceCallId::fields(self.call, visit);
    Body::fields(self.body, visit);
  }
};

// ROS 2 service in the protocol of rmw_cyclonedds_cpp. Incompatible with other DDS vendors, which transfer the client
// id outside of the message.
class ServiceServer {
 public:
  // service: begins with a slash; type: "std_srvs/srv/Trigger". Both endpoints are added to the graph.
  ServiceServer(GraphAnnouncement& graph, const std::string& service, const std::string& type);

  // Requests since the previous call, oldest first, each a ServiceMessage.
  std::vector<Message> take() { return requests_.take(); }

  // Sends a reply, a ServiceMessage, once the client's reader is discovered, as DDS would lose it before. now: of a
  // monotonic clock.
  void reply(std::vector<std::byte> message, std::chrono::nanoseconds now);
  // Sends delayed replies; call it periodically.
  void send_waiting(std::chrono::nanoseconds now);

 private:
  struct Waiting {
    std::vector<std::byte> message;
    std::chrono::nanoseconds until{};
  };

  Subscriber requests_;
  Publisher replies_;
  std::vector<Waiting> waiting_;
};

}  // namespace byre
