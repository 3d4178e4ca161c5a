#include "byre/viewer/web/live_topics.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace byre {

ros::MessageSink::TopicId LiveTopics::add(ros::Topic topic) {
  const std::lock_guard lock(mutex_);
  topics_.push_back(std::move(topic));
  subscribers_.push_back(0);
  return static_cast<TopicId>(topics_.size() - 1);
}

bool LiveTopics::is_wanted(TopicId topic) const {
  const std::lock_guard lock(mutex_);
  return subscribers_[topic] > 0;
}

void LiveTopics::put(TopicId topic, Timestamp time, std::vector<std::byte> cdr) {
  LiveMessage message{topic, time, std::make_shared<const std::vector<std::byte>>(std::move(cdr))};
  const std::lock_guard lock(mutex_);
  if (subscribers_[topic] == 0 && !is_latched(topic)) return;
  waiting_bytes_ += message.cdr->size();
  waiting_.push_back(std::move(message));
  drop_oldest();
}

// Drops the oldest messages; of latched topics only those followed by a newer one.
void LiveTopics::drop_oldest() {
  for (std::size_t i = 0; i + 1 < waiting_.size() && waiting_bytes_ > max_bytes_;) {
    const TopicId topic = waiting_[i].topic;
    const auto newer = std::next(waiting_.begin(), static_cast<std::ptrdiff_t>(i) + 1);
    if (is_latched(topic) && std::ranges::find(newer, waiting_.end(), topic, &LiveMessage::topic) == waiting_.end()) {
      ++i;
      continue;
    }
    waiting_bytes_ -= waiting_[i].cdr->size();
    waiting_.erase(std::prev(newer));
  }
}

std::vector<ros::Topic> LiveTopics::topics_from(std::size_t first) const {
  const std::lock_guard lock(mutex_);
  return {topics_.begin() + static_cast<std::ptrdiff_t>(std::min(first, topics_.size())), topics_.end()};
}

bool LiveTopics::has_topic(std::size_t topic) const {
  const std::lock_guard lock(mutex_);
  return topic < topics_.size();
}

void LiveTopics::subscribe(TopicId topic) {
  const std::lock_guard lock(mutex_);
  ++subscribers_[topic];
}

void LiveTopics::unsubscribe(TopicId topic) {
  const std::lock_guard lock(mutex_);
  --subscribers_[topic];
}

std::vector<LiveMessage> LiveTopics::take() {
  std::deque<LiveMessage> taken;
  {
    const std::lock_guard lock(mutex_);
    taken.swap(waiting_);
    waiting_bytes_ = 0;
    for (const LiveMessage& message : taken) {
      if (is_latched(message.topic)) latched_[message.topic] = message;
    }
  }
  return {std::make_move_iterator(taken.begin()), std::make_move_iterator(taken.end())};
}

std::optional<LiveMessage> LiveTopics::latched(TopicId topic) const {
  const auto found = latched_.find(topic);
  return found == latched_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace byre
