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
  std::string user;  // empty: none is told
  std::string password;
  std::string client_id;
};

struct MqttMessage {
  std::string topic;
  std::string text;
  bool is_retained = false;      // whether the broker gives it to who comes later
  bool is_acknowledged = false;  // sent at least once (QoS 1), else at most once (QoS 0)
};

// A connection to a broker of MQTT, made and made anew by a thread of its own. Nothing of it waits for the broker but
// its end, half a second at most once the broker's name is resolved.
class MqttClient {
 public:
  struct Presence {
    std::function<MqttMessage()> greeting;  // published whenever it is connected; called from the client's thread
    MqttMessage will;                       // published by the broker where the connection breaks
    std::function<MqttMessage()> farewell;  // published when this ends
  };

  MqttClient(const MqttOptions& options, Presence presence);
  ~MqttClient();
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;

  // Hands a message over. Left out without a connection, and while the broker is slow to take earlier ones.
  void publish(const MqttMessage& message);

  int connections() const { return connections_; }  // connections made so far
  bool is_connected() const { return is_connected_; }
  std::string state() const;  // a line for people

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
  std::atomic<int> under_way_ = 0;  // messages that were handed over and have not left yet
  std::atomic<int> refusal_ = 0;    // code by which the broker refused the last connection
  std::atomic<int> fault_ = 0;      // error of the last connection or attempt: MOSQ_ERR, or -errno if negative
  std::jthread thread_;             // runs the client
};

}  // namespace byre
