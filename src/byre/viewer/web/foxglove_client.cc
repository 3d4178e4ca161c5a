#include "byre/viewer/web/foxglove_client.h"

#include "byre/base/byte_stream.h"
#include "byre/base/text_file.h"
#include "byre/viewer/web/web_messages.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace byre {
namespace {

using Json = nlohmann::json;

constexpr std::array<std::string_view, 2> kProtocols = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
constexpr std::uint8_t kMessageData = 1;
constexpr std::uint8_t kTime = 2;
constexpr std::size_t kMaxQuoted = 40;  // bytes of client text quoted in a status message

std::string text_of(const ByteWriter& writer) {
  return {reinterpret_cast<const char*>(writer.bytes().data()), writer.size()};
}

std::optional<std::uint32_t> number_of(const Json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto number = value.get<std::uint64_t>();
  if (number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}

std::optional<std::uint32_t> number_in(const Json& fields, const char* name) {
  if (!fields.is_object() || !fields.contains(name)) return std::nullopt;
  return number_of(fields.at(name));
}

FoxgloveRequest fault(std::string reason) {
  return {{}, {}, std::move(reason)};
}

FoxgloveRequest read_subscribe(const Json& message) {
  const auto wanted = message.find("subscriptions");
  if (wanted == message.end() || !wanted->is_array()) return fault("subscribe has no list of subscriptions");
  FoxgloveRequest request;
  for (const Json& each : *wanted) {
    const auto id = number_in(each, "id");
    const auto channel = number_in(each, "channelId");
    if (!id || !channel) return fault("a subscription has no numbers id and channelId");
    request.subscribe.push_back({*id, *channel});
  }
  return request;
}

FoxgloveRequest read_unsubscribe(const Json& message) {
  const auto given_up = message.find("subscriptionIds");
  if (given_up == message.end() || !given_up->is_array()) return fault("unsubscribe has no list of subscriptionIds");
  FoxgloveRequest request;
  for (const Json& each : *given_up) {
    const auto id = number_of(each);
    if (!id) return fault("a subscriptionId is not a number");
    request.unsubscribe.push_back(*id);
  }
  return request;
}

}  // namespace

std::string_view foxglove_protocol(std::string_view offered) {
  const std::vector<std::string_view> fields = split_fields(offered);
  for (const std::string_view protocol : kProtocols) {
    if (std::ranges::find(fields, protocol) != fields.end()) return protocol;
  }
  return {};
}

std::string server_info_text(std::string_view session) {
  return dump_json({{"op", "serverInfo"},
                    {"name", "byre " BYRE_VERSION},
                    {"capabilities", {"time"}},
                    {"metadata", Json::object()},
                    {"sessionId", session}});
}

std::string advertise_text(std::size_t first, std::span<const ros::Topic> topics) {
  Json channels = Json::array();
  for (const ros::Topic& topic : topics) {
    channels.push_back({{"id", first + channels.size()},
                        {"topic", topic.name},
                        {"encoding", "cdr"},
                        {"schemaName", topic.type},
                        {"schemaEncoding", "ros2msg"},
                        {"schema", topic.schema}});
  }
  return dump_json({{"op", "advertise"}, {"channels", channels}});
}

std::string status_text(StatusLevel level, std::string_view message) {
  return dump_json({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string message_head(std::uint32_t subscription, Timestamp time) {
  ByteWriter writer;
  writer.write(kMessageData);
  writer.write(subscription);
  writer.write(static_cast<std::uint64_t>(time.count()));
  return text_of(writer);
}

std::string time_bytes(Timestamp time) {
  ByteWriter writer;
  writer.write(kTime);
  writer.write(static_cast<std::uint64_t>(time.count()));
  return text_of(writer);
}

FoxgloveRequest read_foxglove_request(std::string_view bytes, bool is_binary) {
  if (is_binary) return fault("byre accepts no messages and offers no services");
  const Json message = Json::parse(bytes, nullptr, false);
  if (!message.is_object()) return fault("the message is not a JSON object");
  const auto op = message.find("op");
  if (op == message.end() || !op->is_string()) return fault("the message has no string op");
  const auto& name = op->get_ref<const std::string&>();
  if (name == "subscribe") return read_subscribe(message);
  if (name == "unsubscribe") return read_unsubscribe(message);
  return fault("only subscribe and unsubscribe are supported, not " + name.substr(0, kMaxQuoted));
}

FoxgloveClient::FoxgloveClient(LiveTopics& topics, std::string_view session, const FoxgloveLimits& limits)
    : topics_(topics), limits_(limits), answers_({server_info_text(session)}) {}

FoxgloveClient::~FoxgloveClient() {
  for (const auto& [id, topic] : subscribed_) topics_.unsubscribe(topic);
}

bool FoxgloveClient::receive(std::string_view bytes, bool is_binary) {
  const FoxgloveRequest request = read_foxglove_request(bytes, is_binary);
  if (!request.fault.empty()) send_error(request.fault);
  for (const FoxgloveRequest::Subscription& wanted : request.subscribe) subscribe(wanted);
  for (const std::uint32_t id : request.unsubscribe) unsubscribe(id);
  return answers_.size() <= limits_.max_answers;
}

void FoxgloveClient::send_error(std::string_view reason) {
  if (answers_.size() <= limits_.max_answers) answers_.push_back(status_text(StatusLevel::error, reason));
}

void FoxgloveClient::subscribe(const FoxgloveRequest::Subscription& wanted) {
  const auto topic = static_cast<ros::MessageSink::TopicId>(wanted.channel);
  const auto has_topic = [topic](const auto& each) { return each.second == topic; };
  if (!topics_.has_topic(wanted.channel)) {
    send_error("unknown channel " + std::to_string(wanted.channel));
  } else if (subscribed_.contains(wanted.id)) {
    send_error("subscription " + std::to_string(wanted.id) + " is in use");
  } else if (std::ranges::any_of(subscribed_, has_topic)) {
    send_error("channel " + std::to_string(wanted.channel) + " is subscribed already");
  } else {
    subscribed_[wanted.id] = topic;
    topics_.subscribe(topic);
    if (auto latched = topics_.latched(topic)) add({wanted.id, false, std::move(*latched)});
  }
}

void FoxgloveClient::unsubscribe(std::uint32_t id) {
  const auto found = subscribed_.find(id);
  if (found == subscribed_.end()) {
    send_error("unknown subscription " + std::to_string(id));
    return;
  }
  topics_.unsubscribe(found->second);
  subscribed_.erase(found);
  std::erase_if(waiting_, [this, id](const Waiting& each) {
    if (each.subscription == id) waiting_bytes_ -= each.message.cdr->size();
    return each.subscription == id;
  });
}

void FoxgloveClient::offer(const LiveMessage& message) {
  const auto found = std::ranges::find(subscribed_, message.topic, [](const auto& each) { return each.second; });
  if (found != subscribed_.end()) add({found->first, true, message});
}

void FoxgloveClient::add(Waiting waiting) {
  waiting_bytes_ += waiting.message.cdr->size();
  waiting_.push_back(std::move(waiting));
  while (waiting_.size() > limits_.max_messages || (waiting_bytes_ > limits_.max_bytes && waiting_.size() > 1)) {
    drop_oldest();
  }
}

// Keeps the last message of latched topics while other messages can be dropped.
void FoxgloveClient::drop_oldest() {
  const auto passes = [this](const Waiting& each) { return !topics_.latched(each.message.topic); };
  const auto found = std::ranges::find_if(waiting_, passes);
  const auto dropped = found == waiting_.end() ? waiting_.begin() : found;
  waiting_bytes_ -= dropped->message.cdr->size();
  waiting_.erase(dropped);
  if (std::exchange(has_dropped_, true) || answers_.size() > limits_.max_answers) return;
  answers_.push_back(status_text(StatusLevel::warning, "messages are dropped, because the client reads too slowly"));
}

std::optional<WebMessage> FoxgloveClient::next() {
  if (!answers_.empty()) {
    WebMessage answer{std::move(answers_.front()), false, nullptr};
    answers_.pop_front();
    return answer;
  }
  if (const std::vector<ros::Topic> topics = topics_.topics_from(advertised_); !topics.empty()) {
    const std::size_t first = std::exchange(advertised_, advertised_ + topics.size());
    return WebMessage{advertise_text(first, topics), false, nullptr};
  }
  if (waiting_.empty()) {
    has_dropped_ = false;
    return std::nullopt;
  }
  Waiting& oldest = waiting_.front();
  if (oldest.is_new && oldest.message.time != time_) {
    time_ = oldest.message.time;
    return WebMessage{time_bytes(time_), true, nullptr};
  }
  WebMessage output{message_head(oldest.subscription, oldest.message.time), true, oldest.message.cdr};
  waiting_bytes_ -= oldest.message.cdr->size();
  waiting_.pop_front();
  return output;
}

}  // namespace byre
