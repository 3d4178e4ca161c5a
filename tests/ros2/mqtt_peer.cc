#include "mqtt_peer.h"

#include "node_scene.h"

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <boost/asio/ip/tcp.hpp>
#include <mosquitto.h>
#include <sys/wait.h>
#include <unistd.h>

namespace byre::testing_ros2 {
namespace {

namespace fs = std::filesystem;
using boost::asio::ip::tcp;

// Debian installs it outside the PATH of normal users.
fs::path broker_program() {
  for (const char* path : {"/usr/sbin/mosquitto", "/usr/bin/mosquitto", "/usr/local/sbin/mosquitto"}) {
    if (fs::exists(path)) return path;
  }
  return {};
}

tcp::endpoint endpoint(int port) {
  return {boost::asio::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(port)};
}

bool answers(int port) {
  boost::asio::io_context context;
  boost::system::error_code error;
  tcp::socket(context).connect(endpoint(port), error);
  return !error;
}

bool wait_until(const std::function<bool()>& condition, std::chrono::milliseconds patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace

bool eventually(const std::function<bool()>& condition) {
  return wait_until(condition, std::chrono::minutes(1));
}

bool MqttBroker::is_installed() {
  return !broker_program().empty();
}

MqttBroker::MqttBroker(const fs::path& folder, const std::string& user, const std::string& password, int port)
    : user_(user), password_(password), port_(port == 0 ? free_port() : port) {
  const std::string config = (folder / "mosquitto.conf").string();
  const std::string passwords = (folder / "passwords").string();
  fs::remove(passwords);
  const std::string command = "mosquitto_passwd -c -b " + passwords + " " + user + " " + password + " 2>/dev/null";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("mosquitto_passwd fails");
  // A broker started by root drops its privileges, and then cannot read the password file.
  std::ofstream(config) << "listener " << port_ << " 127.0.0.1\npassword_file " << passwords
                        << "\nuser root\nlog_dest none\n";
  const std::string program = broker_program().string();
  process_ = fork();
  if (process_ == 0) {
    execl(program.c_str(), program.c_str(), "-c", config.c_str(), nullptr);
    _exit(127);
  }
  if (!eventually([this] { return answers(port_); })) throw std::runtime_error("mosquitto does not start");
}

void MqttBroker::kill() {
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
  process_ = -1;
}

MqttListener::MqttListener(const MqttBroker& broker, const std::string& topics) {
  mosquitto_lib_init();
  client_ = mosquitto_new(nullptr, true, this);
  mosquitto_username_pw_set(client_, broker.user().c_str(), broker.password().c_str());
  mosquitto_message_callback_set(client_, [](mosquitto*, void* self, const mosquitto_message* message) {
    auto& mine = *static_cast<MqttListener*>(self);
    const auto* const text = static_cast<const char*>(message->payload);
    const std::lock_guard lock(mine.mutex_);
    mine.messages_.emplace_back(message->topic, nlohmann::json::parse(text, text + message->payloadlen));
  });
  if (mosquitto_connect(client_, "127.0.0.1", broker.port(), 60) != MOSQ_ERR_SUCCESS ||
      mosquitto_subscribe(client_, nullptr, topics.c_str(), 1) != MOSQ_ERR_SUCCESS ||
      mosquitto_loop_start(client_) != MOSQ_ERR_SUCCESS) {
    throw std::runtime_error("the broker cannot be listened to");
  }
}

MqttListener::~MqttListener() {
  mosquitto_disconnect(client_);
  mosquitto_loop_stop(client_, true);
  mosquitto_destroy(client_);
}

std::optional<nlohmann::json> MqttListener::find(const std::string& topic, const Condition& condition,
                                                 std::chrono::milliseconds patience) {
  std::optional<nlohmann::json> found;
  wait_until(
      [&] {
        const std::lock_guard lock(mutex_);
        for (const auto& [name, message] : messages_) {
          if (!found && name == topic && condition(message)) found = message;
        }
        return found.has_value();
      },
      patience);
  return found;
}

}  // namespace byre::testing_ros2
