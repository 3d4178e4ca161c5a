#include "byre/viewer/web/foxglove_client.h"

#include <algorithm>
#include <utility>

namespace byre {

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
