#pragma once

#include "byre/bag/bag.h"

#include <string>
#include <vector>

namespace byre {

// A message and the time of its header.
struct TimedMessage {
  Timestamp time{};
  BagMessage message;
};

struct TimedMessages {
  std::vector<TimedMessage> messages;
  std::vector<std::string> warnings;  // counts of what is out of order or left out
};

// How warnings name messages.
struct MessageNames {
  std::string place;  // the bag
  std::string kind;   // what they are, in the plural
};

// The messages of a topic in the order of the times in their headers, each later than the one before. Where no header
// has a time, those of the recorder are taken.
TimedMessages timed_messages(const BagContent& content, std::size_t topic, const MessageNames& names);

}  // namespace byre
