#include "byre/ros2/fleet/mqtt_client.h"

#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <mosquitto.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;

constexpr int kKeepAlive = 15;        // seconds without a message before a ping
constexpr auto kRetry = 1000ms;       // pause before reconnecting
constexpr auto kStep = 20ms;          // polling interval
constexpr auto kMaxFarewell = 500ms;  // time to send the last message
constexpr int kLoopWait = 100;        // milliseconds
constexpr int kMaxInFlight = 8;       // messages

// The library is initialised once, and never released.
void set_up_library() {
  static const int result = mosquitto_lib_init();
  if (result != MOSQ_ERR_SUCCESS) throw std::runtime_error("MQTT: the library cannot be set up");
}

void require_done(int code, const char* doing) {
  if (code != MOSQ_ERR_SUCCESS) {
    throw std::runtime_error(std::string("MQTT: cannot ") + doing + ": " + mosquitto_strerror(code));
  }
}

int qos_of(const MqttMessage& message) {
  return message.is_acknowledged ? 1 : 0;
}

template <typename Condition>
void wait_at_most(std::chrono::milliseconds most, Condition is_over) {
  const auto end = std::chrono::steady_clock::now() + most;
  while (!is_over() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(kStep);
}

}  // namespace

void MqttClient::Deleter::operator()(mosquitto* client) const {
  mosquitto_destroy(client);
}

MqttClient::MqttClient(const MqttOptions& options, Presence presence)
    : options_(options), presence_(std::move(presence)) {
  set_up_library();
  client_.reset(mosquitto_new(options_.client_id.c_str(), true, this));
  if (!client_) throw std::runtime_error("MQTT: cannot create a client with the id " + options_.client_id);
  mosquitto* const client = client_.get();
  require_done(mosquitto_threaded_set(client, true), "use a thread");
  mosquitto_connect_callback_set(client, note_connect);
  mosquitto_disconnect_callback_set(client, note_disconnect);
  mosquitto_publish_callback_set(client, note_published);
  const MqttMessage& will = presence_.will;
  require_done(mosquitto_will_set(client, will.topic.c_str(), static_cast<int>(will.text.size()), will.text.data(),
                                  qos_of(will), will.is_retained),
               "set a will");
  if (!options_.user.empty()) {
    require_done(mosquitto_username_pw_set(client, options_.user.c_str(), options_.password.c_str()), "set the user");
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

MqttClient::~MqttClient() {
  if (is_connected_) {
    send(presence_.farewell());
    wait_at_most(kMaxFarewell, [this] { return in_flight_ == 0 || !is_connected_; });
    mosquitto_disconnect(client_.get());
    wait_at_most(kMaxFarewell, [this] { return !is_connected_; });
  }
  thread_.request_stop();
  thread_.join();
}

void MqttClient::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    int code = mosquitto_connect_async(client_.get(), options_.host.c_str(), options_.port, kKeepAlive);
    while (code == MOSQ_ERR_SUCCESS && !stop.stop_requested()) code = mosquitto_loop(client_.get(), kLoopWait, 1);
    is_connected_ = false;
    in_flight_ = 0;
    fault_ = code == MOSQ_ERR_ERRNO ? -errno : code;  // errno is per thread
    wait_at_most(kRetry, [&stop] { return stop.stop_requested(); });
  }
}

void MqttClient::send(const MqttMessage& message) {
  ++in_flight_;
  const int code =
      mosquitto_publish(client_.get(), nullptr, message.topic.c_str(), static_cast<int>(message.text.size()),
                        message.text.data(), qos_of(message), message.is_retained);
  if (code != MOSQ_ERR_SUCCESS) note_published(nullptr, this, 0);
}

void MqttClient::publish(const MqttMessage& message) {
  if (is_connected_ && in_flight_ < kMaxInFlight) send(message);
}

void MqttClient::note_connect(mosquitto* /*client*/, void* self, int code) {
  auto& mine = *static_cast<MqttClient*>(self);
  mine.refusal_ = code;
  if (code != 0) return;
  mine.send(mine.presence_.greeting());
  ++mine.connections_;
  mine.is_connected_ = true;
}

void MqttClient::note_disconnect(mosquitto* /*client*/, void* self, int /*code*/) {
  static_cast<MqttClient*>(self)->is_connected_ = false;
}

// Acknowledgements of messages from an earlier connection are not counted.
void MqttClient::note_published(mosquitto* /*client*/, void* self, int /*id*/) {
  std::atomic<int>& in_flight = static_cast<MqttClient*>(self)->in_flight_;
  int count = in_flight;
  while (count > 0 && !in_flight.compare_exchange_weak(count, count - 1)) {
  }
}

std::string MqttClient::state() const {
  const std::string broker = fmt::format("{}:{}", options_.host, options_.port);
  if (is_connected_) return "connected to " + broker;
  if (refusal_ != 0) return broker + " refuses the connection: " + mosquitto_connack_string(refusal_);
  if (const int fault = fault_; fault != 0) {
    const std::string reason = fault < 0 ? std::generic_category().message(-fault) : mosquitto_strerror(fault);
    return broker + " cannot be reached: " + reason + " (start the broker, or correct mqtt.host and mqtt.port)";
  }
  return "connecting to " + broker;
}

}  // namespace byre
