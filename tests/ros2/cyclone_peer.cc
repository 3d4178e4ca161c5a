#include "cyclone_peer.h"

#include <stdexcept>

namespace byre::testing_ros2 {

namespace {

// Unicast discovery on the loopback interface, as ROS does when confined to it.
constexpr const char* kLoopback =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>"
    "</Domain></CycloneDDS>";

dds_entity_t checked(dds_entity_t entity) {
  if (entity < 0) throw std::runtime_error(std::string("Cyclone DDS: ") + dds_strretcode(entity));
  return entity;
}

dds_qos_t* qos_of(const PeerQos& wanted) {
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, wanted.is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(1));
  dds_qset_durability(qos, wanted.is_latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, wanted.depth);
  return qos;
}

}  // namespace

CyclonePeer::CyclonePeer(int domain)
    : domain_(checked(dds_create_domain(static_cast<dds_domainid_t>(domain), kLoopback))),
      participant_(checked(dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr))) {}

dds_entity_t CyclonePeer::writer(const std::string& topic, const dds_topic_descriptor_t& type, const PeerQos& wanted) {
  dds_qos_t* const qos = qos_of(wanted);
  const dds_entity_t name = checked(dds_create_topic(participant_, &type, topic.c_str(), nullptr, nullptr));
  const dds_entity_t writer = dds_create_writer(participant_, name, qos, nullptr);
  dds_delete_qos(qos);
  return checked(writer);
}

dds_entity_t CyclonePeer::reader(const std::string& topic, const dds_topic_descriptor_t& type, const PeerQos& wanted) {
  dds_qos_t* const qos = qos_of(wanted);
  const dds_entity_t name = checked(dds_create_topic(participant_, &type, topic.c_str(), nullptr, nullptr));
  const dds_entity_t reader = dds_create_reader(participant_, name, qos, nullptr);
  dds_delete_qos(qos);
  return checked(reader);
}

bool CyclonePeer::has_subscriber(dds_entity_t writer) {
  for (int i = 0; i < 4000; ++i) {
    dds_publication_matched_status_t matched{};
    if (dds_get_publication_matched_status(writer, &matched) == DDS_RETCODE_OK && matched.current_count > 0)
      return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace byre::testing_ros2
