#pragma once

#include "byre/bag/bag.h"
#include "byre/dataset/restored_times.h"

#include <string>
#include <vector>

namespace byre {

struct TimedMessage {
  Timestamp time{};
  BagMessage message;
};

struct TimedMessages {
  std::vector<TimedMessage> messages;
  TimeCorrections corrections;
  SensorClock clock;
  std::vector<std::string> warnings;  // what was corrected or left out, with counts
};

// The messages of a topic in the order of their times, each later than the one before. Times are those of the headers,
// continued over steps of the clock (restore_times). The order of recording is that of the receive times, or of the
// file where the recorder's clock was set, too. other: clock of the images, for topics of other sensors.
// names: place is the bag.
TimedMessages timed_messages(const BagContent& content, std::size_t topic, const ItemNames& names,
                             const SensorClock& other = {});

}  // namespace byre
