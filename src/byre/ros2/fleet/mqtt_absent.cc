// The MQTT client of a build without libmosquitto, which cannot be constructed.
#include "byre/input_error.h"
#include "byre/ros2/fleet/mqtt_client.h"

namespace byre {

MqttClient::MqttClient(const MqttOptions& options, Presence) {
  throw InputError("mqtt.host", "is " + options.host + ", but this build has no MQTT",
                   "remove the setting, or install libmosquitto-dev and build byre with -DBYRE_WITH_MOSQUITTO=ON");
}

MqttClient::~MqttClient() = default;

void MqttClient::Deleter::operator()(mosquitto*) const {}

void MqttClient::publish(const MqttMessage&) {}

std::string MqttClient::state() const {
  return {};
}

}  // namespace byre
