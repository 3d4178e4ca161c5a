#include "byre/dataset/timed_messages.h"

#include "byre/dataset/bag_image.h"

#include <algorithm>

namespace byre {

TimedMessages timed_messages(const BagContent& content, std::size_t topic, const MessageNames& names) {
  TimedMessages timed;
  auto& [messages, warnings] = timed;
  for (const BagMessage& message : content.messages) {
    if (message.topic == topic) messages.push_back({stamp_of(content, message), message});
  }
  const std::string name = names.place + ": " + content.topics[topic].name + ": ";
  if (std::ranges::all_of(messages, [](const TimedMessage& each) { return each.time == Timestamp(0); })) {
    warnings.push_back(name + "has no time stamps in its headers, so those of the recorder are taken");
    for (TimedMessage& each : messages) each.time = each.message.log_time;
  }
  std::size_t late = 0;
  for (std::size_t i = 1; i < messages.size(); ++i) late += messages[i].time < messages[i - 1].time ? 1 : 0;
  if (late > 0) {
    warnings.push_back(name + std::to_string(late) + " " + names.kind + " were recorded after later ones");
  }
  std::ranges::stable_sort(messages, {}, &TimedMessage::time);
  const auto repeated = std::ranges::unique(messages, {}, &TimedMessage::time);
  if (!repeated.empty()) {
    warnings.push_back(name + std::to_string(repeated.size()) + " " + names.kind +
                       " bear the time of another and are left out");
  }
  messages.erase(repeated.begin(), repeated.end());
  return timed;
}

}  // namespace byre
