#pragma once

#include "fast_peer.h"

#include <cstddef>
#include <functional>
#include <string>
#include <thread>

#include <dds/dds.h>

namespace byre::testing_ros2 {

// A ROS 2 participant by Cyclone DDS with types of its own generator, on the loopback interface.
class CyclonePeer {
 public:
  explicit CyclonePeer(int domain);
  ~CyclonePeer() { dds_delete(domain_); }
  CyclonePeer(const CyclonePeer&) = delete;
  CyclonePeer& operator=(const CyclonePeer&) = delete;

  dds_entity_t writer(const std::string& topic, const dds_topic_descriptor_t& type, const PeerQos& qos);
  dds_entity_t reader(const std::string& topic, const dds_topic_descriptor_t& type, const PeerQos& qos);

  static bool has_subscriber(dds_entity_t writer);  // within some seconds

 private:
  dds_entity_t domain_;
  dds_entity_t participant_;
};

// Takes messages for some seconds, until one fits.
template <typename Message>
bool take_until(dds_entity_t reader, const std::function<bool(const Message&)>& fits,
                std::chrono::seconds patience = std::chrono::seconds(20)) {
  const auto end = std::chrono::steady_clock::now() + patience;
  do {
    void* sample = nullptr;
    dds_sample_info_t info;
    while (dds_take(reader, &sample, &info, 1, 1) > 0) {
      const bool is_found = info.valid_data && fits(*static_cast<const Message*>(sample));
      dds_return_loan(reader, &sample, 1);
      if (is_found) return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  } while (std::chrono::steady_clock::now() < end);
  return false;
}

}  // namespace byre::testing_ros2
