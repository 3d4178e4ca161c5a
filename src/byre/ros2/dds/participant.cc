#include "byre/ros2/dds/participant.h"

#include "byre/ros2/dds/cdr_type.h"

#include <algorithm>
#include <stdexcept>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

namespace byre {
namespace {

using Qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;

Qos make_qos(const TopicQos& wanted) {
  // ROS writers block without limit; tracking must not wait.
  constexpr dds_duration_t kLongestWait = DDS_MSECS(20);
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), wanted.is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       kLongestWait);
  dds_qset_durability(qos.get(), wanted.is_latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, wanted.depth);
  return qos;
}

void set_user_data(dds_qos_t* qos, const MessageType& type, std::string user_data, RosDistribution distribution) {
  if (distribution != RosDistribution::humble && !type.hash.empty()) user_data += "typehash=" + type.hash + ";";
  if (!user_data.empty()) dds_qset_userdata(qos, user_data.data(), user_data.size());
}

std::pair<DdsEntity, const ddsi_sertype*> make_topic(std::int32_t participant, const std::string& topic,
                                                     const MessageType& type, std::size_t max_bytes) {
  const std::string name = topic.starts_with('/') ? dds_topic_name(topic) : topic;
  ddsi_sertype* cdr_type = make_cdr_type(dds_type_name(type.name), max_bytes);
  const dds_entity_t made = dds_create_topic_sertype(participant, name.c_str(), &cdr_type, nullptr, nullptr, nullptr);
  if (made < 0) ddsi_sertype_unref(cdr_type);
  return {DdsEntity(made, "make the topic " + topic), cdr_type};
}

EntityId id_of(std::int32_t handle) {
  dds_guid_t guid{};
  dds_get_guid(handle, &guid);
  EntityId id{};
  std::copy_n(guid.v, id.size(), id.begin());
  return id;
}

}  // namespace

DdsEntity::DdsEntity(std::int32_t handle, const std::string& doing) : handle_(handle) {
  if (handle < 0) throw std::runtime_error("DDS cannot " + doing + ": " + dds_strretcode(handle));
}

DdsEntity& DdsEntity::operator=(DdsEntity&& other) noexcept {
  std::swap(handle_, other.handle_);
  return *this;
}

DdsEntity::~DdsEntity() {
  if (handle_ > 0) dds_delete(handle_);
}

void Publisher::publish(std::vector<std::byte> message) {
  ddsi_serdata* const sample = make_cdr_sample(type_, std::move(message));
  if (sample == nullptr || dds_writecdr(writer_.handle(), sample) != DDS_RETCODE_OK) ++dropped_;
}

int Publisher::subscribers() const {
  dds_publication_matched_status_t matched{};
  const bool is_known = dds_get_publication_matched_status(writer_.handle(), &matched) == DDS_RETCODE_OK;
  return is_known ? static_cast<int>(matched.current_count) : 0;
}

EntityId Publisher::id() const {
  return id_of(writer_.handle());
}

Message& Message::operator=(Message&& other) noexcept {
  std::swap(taken_, other.taken_);
  return *this;
}

Message::~Message() {
  if (taken_ != nullptr) ddsi_serdata_unref(taken_);
}

std::span<const std::byte> Message::bytes() const {
  return bytes_of(*taken_);
}

std::vector<Message> Subscriber::take() {
  constexpr std::size_t kAtOnce = 16;
  std::vector<Message> messages;
  for (;;) {
    std::array<ddsi_serdata*, kAtOnce> taken{};
    std::array<dds_sample_info_t, kAtOnce> about{};
    const dds_return_t count = dds_takecdr(reader_.handle(), taken.data(), kAtOnce, about.data(), DDS_ANY_STATE);
    for (int i = 0; i < count; ++i) {
      Message message(taken[static_cast<std::size_t>(i)]);
      if (about[static_cast<std::size_t>(i)].valid_data) messages.push_back(std::move(message));
    }
    if (count < static_cast<dds_return_t>(kAtOnce)) return messages;
  }
}

int Subscriber::publishers() const {
  dds_subscription_matched_status_t matched{};
  const bool is_known = dds_get_subscription_matched_status(reader_.handle(), &matched) == DDS_RETCODE_OK;
  return is_known ? static_cast<int>(matched.current_count) : 0;
}

EntityId Subscriber::id() const {
  return id_of(reader_.handle());
}

Participant::Participant(const RosNetwork& network, const std::string& own_settings)
    : distribution_(network.distribution) {
  const auto number = static_cast<dds_domainid_t>(network.domain);
  const std::string doing = "join the domain " + std::to_string(network.domain);
  domain_ = DdsEntity(dds_create_domain(number, cyclone_settings(network, own_settings).c_str()), doing);
  const Qos qos(dds_create_qos(), &dds_delete_qos);
  constexpr std::string_view kEnclave = "enclave=/;";  // identifies a ROS process
  dds_qset_userdata(qos.get(), kEnclave.data(), kEnclave.size());
  participant_ = DdsEntity(dds_create_participant(number, qos.get(), nullptr), doing);
  wake_ = DdsEntity(dds_create_waitset(participant_.handle()), doing);
}

Publisher Participant::publish(const std::string& topic, const MessageType& type, const TopicQos& qos,
                               const std::string& note) {
  auto [made, cdr_type] = make_topic(participant_.handle(), topic, type, qos.max_bytes);
  const Qos wanted = make_qos(qos);
  set_user_data(wanted.get(), type, note, distribution_);
  dds_qset_writer_data_lifecycle(wanted.get(), false);
  if (qos.is_latched) {
    dds_qset_durability_service(wanted.get(), 0, DDS_HISTORY_KEEP_LAST, qos.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  Publisher publisher;
  publisher.topic_ = std::move(made);
  publisher.type_ = cdr_type;
  publisher.writer_ = DdsEntity(
      dds_create_writer(participant_.handle(), publisher.topic_.handle(), wanted.get(), nullptr), "publish " + topic);
  return publisher;
}

Subscriber Participant::subscribe(const std::string& topic, const MessageType& type, const TopicQos& qos,
                                  const std::string& note) {
  const Qos wanted = make_qos(qos);
  set_user_data(wanted.get(), type, note, distribution_);
  if (qos.ignores_own) dds_qset_ignorelocal(wanted.get(), DDS_IGNORELOCAL_PARTICIPANT);
  Subscriber subscriber;
  subscriber.topic_ = make_topic(participant_.handle(), topic, type, qos.max_bytes).first;
  subscriber.reader_ =
      DdsEntity(dds_create_reader(participant_.handle(), subscriber.topic_.handle(), wanted.get(), nullptr),
                "subscribe to " + topic);
  subscriber.condition_ =
      DdsEntity(dds_create_readcondition(subscriber.reader_.handle(), DDS_ANY_STATE), "wait for " + topic);
  dds_waitset_attach(wake_.handle(), subscriber.condition_.handle(), 0);
  return subscriber;
}

std::vector<DiscoveredPublisher> Participant::publishers(const std::string& topic) {
  constexpr std::size_t kMax = 1000;
  constexpr std::uint32_t kAlive = DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE;
  if (publications_.handle() <= 0) {
    publications_ =
        DdsEntity(dds_create_reader(participant_.handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                  "read topic announcements");
  }
  std::vector<void*> read(kMax, nullptr);
  std::vector<dds_sample_info_t> about(kMax);
  const dds_return_t count = dds_read_mask(publications_.handle(), read.data(), about.data(), kMax, kMax, kAlive);
  const std::string name = dds_topic_name(topic);
  std::vector<DiscoveredPublisher> found;
  for (int i = 0; i < count; ++i) {
    if (!about[static_cast<std::size_t>(i)].valid_data) continue;
    const auto* const endpoint = static_cast<const dds_builtintopic_endpoint_t*>(read[static_cast<std::size_t>(i)]);
    const bool is_own = std::ranges::equal(endpoint->participant_key.v, id());
    if (is_own || name != endpoint->topic_name) continue;
    auto reliability = DDS_RELIABILITY_BEST_EFFORT;
    auto durability = DDS_DURABILITY_VOLATILE;
    dds_qget_reliability(endpoint->qos, &reliability, nullptr);
    dds_qget_durability(endpoint->qos, &durability);
    found.push_back({ros_type_name(endpoint->type_name), reliability == DDS_RELIABILITY_RELIABLE,
                     durability != DDS_DURABILITY_VOLATILE});
  }
  if (count > 0) dds_return_loan(publications_.handle(), read.data(), count);
  return found;
}

void Participant::wait(std::chrono::nanoseconds longest) {
  dds_waitset_wait(wake_.handle(), nullptr, 0, longest.count());
}

EntityId Participant::id() const {
  return id_of(participant_.handle());
}

}  // namespace byre
