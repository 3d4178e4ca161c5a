#pragma once

#include "byre/dds/participant.h"
#include "byre/dds/ros_graph.h"
#include "byre/ros/message.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// What comes before the fields of a request, and of the reply to it: who asked, and which of its requests it is.
struct ServiceCallId {
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  static void fields(auto& self, auto& visit) {
    visit("client", self.client);
    visit("sequence", self.sequence);
  }
};

// A request or a reply as it is on the wire. Body: that of a struct of ros/services.h.
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

// A service of ROS 2 as programs by its Cyclone DDS have it (rmw_cyclonedds_cpp). Those by other vendors' DDS, who tell
// the caller apart from the message, neither understand it nor are understood.
class ServiceServer {
 public:
  // service: begins with a slash; type: "std_srvs/srv/Trigger". The graph is told of both its ends.
  ServiceServer(Participant& participant, GraphAnnouncement& graph, const std::string& service,
                const std::string& type);

  // Requests that came since it was asked last, the oldest first, each a ServiceMessage.
  std::vector<Message> take() { return requests_.take(); }

  // Hands over a reply, a ServiceMessage, now or once its reader is there: whoever asks may be heard before it hears,
  // and what it does not hear is lost. now: of a clock that never goes back.
  void reply(std::vector<std::byte> message, std::chrono::nanoseconds now);
  // To be called now and then, for replies that wait.
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
