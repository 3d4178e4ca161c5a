#pragma once

#include "byre/frame_report.h"
#include "byre/ros2/fleet/mqtt_client.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace byre {

// Velocity of the robot in its own frame.
struct FleetVelocity {
  double vx = 0.0;     // m/s, ahead
  double vy = 0.0;     // m/s, to the left
  double omega = 0.0;  // rad/s, counterclockwise
};

// Position of a robot for fleet managers.
struct FleetPosition {
  double x = 0.0, y = 0.0;                // metres, in the frame of the map or of its floor plan
  double theta = 0.0;                     // yaw, radians from -pi to pi, counterclockwise from the x axis
  bool is_initialised = false;            // whether the position is valid
  double score = 0.0;                     // confidence from 0 to 1, see localization_score
  std::optional<double> deviation;        // metres, see position_error
  std::optional<FleetVelocity> velocity;  // empty without odometry
  std::string problem;                    // reason why the position is not trusted; empty if trusted
  std::string advice;                     // remedy for the problem; may be empty
};

// 0.5 to 1 for trusted poses, falling with the share of the permitted error; at most 0.4 if degraded, 0.1 if untrusted,
// and 0 without a pose.
double localization_score(const FrameReport& report);

// Position from the frames so far. Valid from the first trusted frame on, until the event navigation_error, or until
// frames cease.
class FleetPositionKeeper {
 public:
  // The report's pose is in the published frame. arrived: of a monotonic clock; advice: remedy for the frame's doubt.
  void note(const FrameReport& report, Timestamp arrived, const std::string& advice);

  // Starts over for another map or global relocalisation.
  void restart();

  FleetPosition at(Timestamp now) const;

 private:
  struct Odometry {
    Timestamp time{};
    Pose odometry_from_body;
  };

  FleetPosition position_;
  std::optional<Odometry> odometry_;
  std::optional<Timestamp> arrived_;
};

// Messages of VDA 5050, version 2.1, with the fields that byre can fill. See github.com/VDA5050/VDA5050, json_schemas/.

// Identity of a robot: the leading parts of its topics.
struct FleetIdentity {
  std::string interface_name = "uagv";
  std::string manufacturer = "byre";
  std::string serial_number = "byre";
};

// Fault of a manufacturer or serial number; empty if valid.
std::string_view fault_in_identity(std::string_view text);

// Topic such as "uagv/v2/byre/robot7/state".
std::string fleet_topic(const FleetIdentity& identity, std::string_view topic);

struct FleetHeader {
  std::uint32_t id = 0;  // number of the message on its topic
  std::chrono::system_clock::time_point time;
};

// Map of the position.
struct FleetMap {
  std::string id;
  std::string description;  // may be empty
};

enum class FleetConnection : std::uint8_t { online, offline, broken };

std::string connection_text(const FleetIdentity& identity, const FleetHeader& header, FleetConnection state);

std::string visualization_text(const FleetIdentity& identity, const FleetHeader& header, const FleetPosition& position,
                               const FleetMap& map);

// Fields without data have neutral values: no order, an empty battery, no emergency stop. The operating mode is MANUAL,
// which prevents orders. A position that is not trusted is an error: FATAL if invalid, else WARNING.
std::string state_text(const FleetIdentity& identity, const FleetHeader& header, const FleetPosition& position,
                       const FleetMap& map);

// Schedules VDA 5050 messages: visualization at a fixed rate; state on change, after each connection, and at least
// every 30 s.
class FleetReporter {
 public:
  using Send = std::function<void(const MqttMessage&)>;
  using WallTime = std::chrono::system_clock::time_point;

  // rate: largest number of messages per second and topic
  FleetReporter(const FleetIdentity& identity, double rate, Send send);

  // now: of a monotonic clock; connections: number of connections so far
  void publish(const FleetPosition& position, const FleetMap& map, Timestamp now, WallTime wall, int connections);

 private:
  struct SentState {
    Timestamp at{};
    std::string summary;  // content whose change triggers a message
  };

  bool is_state_due(const std::string& summary, Timestamp now, int connections) const;

  // Constant after construction.
  FleetIdentity identity_;
  Timestamp interval_;
  Send send_;

  std::uint32_t states_ = 0, visualizations_ = 0;  // messages so far
  std::optional<SentState> state_;
  std::optional<Timestamp> visualization_;  // time of the last message
  int connections_ = 0;                     // number of connections at the last state message
};

struct FleetOptions {
  MqttOptions broker;  // the client id is derived from the identity
  FleetIdentity identity;
  double rate = 2.0;  // largest number of messages per second and topic
};

// Publishes the robot's position to a fleet manager by MQTT. Call it from one thread; never blocks.
class FleetLink {
 public:
  explicit FleetLink(const FleetOptions& options);

  // Adds a frame, see FleetPositionKeeper.
  void note(const FrameReport& report, Timestamp arrived, const std::string& advice);
  void restart() { keeper_.restart(); }

  // Publishes due messages. now: of a monotonic clock.
  void publish(const FleetMap& map, Timestamp now);

  // Change of the connection state, a line of text.
  std::optional<std::string> connection_change();

 private:
  FleetPositionKeeper keeper_;
  std::string last_connection_;
  MqttClient client_;
  FleetReporter reporter_;
};

}  // namespace byre
