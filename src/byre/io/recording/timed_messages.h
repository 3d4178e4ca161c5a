#pragma once

#include "byre/io/bag/bag.h"
#include "byre/io/recording/restored_times.h"

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
  std::vector<std::string> warnings;  // corrections and dropped messages, with counts
};

// The messages of a topic in order of time, strictly increasing. Times are header stamps, corrected by restore_times.
// The order of recording is that of receive times; of the file, if the recorder's clock was set too. other: clock of
// the images, for topics of other sensors. names: place is the bag.
TimedMessages timed_messages(const BagContent& content, std::size_t topic, const ItemNames& names,
                             const SensorClock& other = {});

}  // namespace byre
