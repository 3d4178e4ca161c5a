#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

struct mosquitto;

namespace byre {

struct MqttOptions {
  std::string host;
  int port = 1883;
  std::string user;  // empty: no login
  std::string password;
  std::string client_id;
};

struct MqttMessage {
  std::string topic;
  std::string text;
  bool is_retained = false;      // whether the broker keeps it for late subscribers
  bool is_acknowledged = false;  // at least once (QoS 1) instead of at most once (QoS 0)
};

// Connection to an MQTT broker; connects and reconnects on its own thread. Only destruction waits for the broker: half
// a second at most, after name resolution.
class MqttClient {
 public:
  struct Presence {
    std::function<MqttMessage()> greeting;  // published after each connection; called from the client's thread
    MqttMessage will;                       // published by the broker if the connection breaks
    std::function<MqttMessage()> farewell;  // published on destruction
  };

  MqttClient(const MqttOptions& options, Presence presence);
  ~MqttClient();
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;

  // Queues a message. Drops it without a connection, and while the broker is slow.
  void publish(const MqttMessage& message);

  int connections() const { return connections_; }  // number of connections so far
  bool is_connected() const { return is_connected_; }
  std::string state() const;  // a line of text

 private:
  struct Deleter {
    void operator()(mosquitto* client) const;
  };

  void run(const std::stop_token& stop);
  void send(const MqttMessage& message);
  static void note_connect(mosquitto* client, void* self, int code);
  static void note_disconnect(mosquitto* client, void* self, int code);
  static void note_published(mosquitto* client, void* self, int id);

  // Constant after construction.
  MqttOptions options_;
  Presence presence_;
  std::unique_ptr<mosquitto, Deleter> client_;

  std::atomic<bool> is_connected_ = false;
  std::atomic<int> connections_ = 0;
  std::atomic<int> in_flight_ = 0;  // messages queued and not yet sent
  std::atomic<int> refusal_ = 0;    // broker's error code for the last connection
  std::atomic<int> fault_ = 0;      // error of the last attempt or connection: MOSQ_ERR, or -errno if negative
  std::jthread thread_;             // runs the client
};

}  // namespace byre
