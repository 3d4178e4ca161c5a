#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/types.h>

struct mosquitto;

namespace byre::testing_ros2 {

// Polls until the condition holds, for up to a minute.
bool eventually(const std::function<bool()>& condition);

// An MQTT broker on the loopback interface with one user. The destructor kills it.
class MqttBroker {
 public:
  static bool is_installed();

  // port: 0 for any free one. Returns once the broker answers.
  MqttBroker(const std::filesystem::path& folder, const std::string& user, const std::string& password, int port = 0);
  ~MqttBroker() { kill(); }
  MqttBroker(const MqttBroker&) = delete;
  MqttBroker& operator=(const MqttBroker&) = delete;

  void kill();
  int port() const { return port_; }
  const std::string& user() const { return user_; }
  const std::string& password() const { return password_; }

 private:
  std::string user_, password_;
  int port_ = 0;
  pid_t process_ = -1;
};

class MqttListener {
 public:
  using Condition = std::function<bool(const nlohmann::json&)>;

  MqttListener(const MqttBroker& broker, const std::string& topics);
  ~MqttListener();
  MqttListener(const MqttListener&) = delete;
  MqttListener& operator=(const MqttListener&) = delete;

  // The first message of a topic that fulfils the condition, waiting for it up to patience.
  std::optional<nlohmann::json> find(const std::string& topic, const Condition& condition,
                                     std::chrono::milliseconds patience = std::chrono::minutes(1));

 private:
  mosquitto* client_;
  std::mutex mutex_;
  std::vector<std::pair<std::string, nlohmann::json>> messages_;  // topic and text; guarded by mutex_
};

}  // namespace byre::testing_ros2
