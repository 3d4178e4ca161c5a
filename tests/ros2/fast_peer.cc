#include "fast_peer.h"

#include <stdexcept>
#include <thread>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

namespace byre::testing_ros2 {

using namespace eprosima::fastdds::dds;

namespace {

constexpr std::chrono::seconds kPatience(20);

template <typename Qos>
void set(Qos& qos, const PeerQos& wanted) {
  qos.reliability().kind = wanted.is_reliable ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = wanted.is_latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = wanted.depth;
  qos.data_sharing().off();
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

}  // namespace

FastPeer::FastPeer(int domain) {
  DomainParticipantQos qos;
  const auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  transport->interfaceWhiteList = {"127.0.0.1"};
  transport->sendBufferSize = transport->receiveBufferSize = 4 << 20;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {transport};
  // Unicast discovery on localhost, as ROS does when confined to it.
  eprosima::fastrtps::rtps::Locator_t localhost;
  eprosima::fastrtps::rtps::IPLocator::setIPv4(localhost, "127.0.0.1");
  qos.wire_protocol().builtin.initialPeersList.push_back(localhost);
  participant_ = DomainParticipantFactory::get_instance()->create_participant(static_cast<DomainId_t>(domain), qos);
  if (participant_ == nullptr) throw std::runtime_error("Fast DDS cannot join the domain");
  publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
}

FastPeer::~FastPeer() {
  participant_->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

Topic* FastPeer::topic(const std::string& name, TypeSupport type) {
  type.register_type(participant_);
  if (auto* const known = dynamic_cast<Topic*>(participant_->lookup_topicdescription(name))) return known;
  return participant_->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT);
}

DataWriter* FastPeer::writer(const std::string& name, TypeSupport type, const PeerQos& wanted) {
  DataWriterQos qos;
  set(qos, wanted);
  qos.reliable_writer_qos().times.heartbeatPeriod = eprosima::fastrtps::Duration_t(0.05);
  qos.publish_mode().kind = wanted.is_reliable ? ASYNCHRONOUS_PUBLISH_MODE : SYNCHRONOUS_PUBLISH_MODE;
  return publisher_->create_datawriter(topic(name, type), qos);
}

DataReader* FastPeer::reader(const std::string& name, TypeSupport type, const PeerQos& wanted,
                             DataReaderListener* listener) {
  DataReaderQos qos;
  set(qos, wanted);
  return subscriber_->create_datareader(topic(name, type), qos, listener);
}

bool FastPeer::has_subscriber(DataWriter* writer) {
  PublicationMatchedStatus matched;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < end) {
    writer->get_publication_matched_status(matched);
    if (matched.current_count > 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace byre::testing_ros2
