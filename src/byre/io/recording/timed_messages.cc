#include "byre/io/recording/timed_messages.h"

#include "byre/io/recording/bag_image.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace byre {
namespace {

// Key by which messages ascend in the order of writing.
auto order_in_file(const MessagePlace& place) {
  return std::tuple(place.file, place.chunk.value_or(place.begin), place.begin);
}

// Messages in the order of recording, and continuous times of reception.
struct ReceivedMessages {
  std::vector<BagMessage> messages;
  std::vector<Timestamp> received;
};

ReceivedMessages in_order_of_reception(const BagContent& content, std::size_t topic) {
  ReceivedMessages result;
  for (const BagMessage& message : content.messages) {
    if (message.topic == topic) result.messages.push_back(message);
  }
  std::vector<BagMessage> as_written = result.messages;
  std::ranges::stable_sort(as_written, {}, [](const BagMessage& message) { return order_in_file(message.place); });
  RecordedStamps log;
  for (const BagMessage& message : as_written) log.stamps.push_back(message.log_time);
  const RestoredTimes restored = restore_times(log);
  if (restored.corrections.clock_steps.empty()) {
    for (const BagMessage& message : result.messages) result.received.push_back(message.log_time);
    return result;
  }
  std::vector<std::size_t> order(as_written.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return restored.times_of_all[i]; });
  for (std::size_t i = 0; i < order.size(); ++i) result.messages[i] = as_written[order[i]];
  for (const std::size_t i : order) result.received.push_back(restored.times_of_all[i]);
  return result;
}

}  // namespace

TimedMessages timed_messages(const BagContent& content, std::size_t topic, const ItemNames& names,
                             const SensorClock& other) {
  ReceivedMessages recorded = in_order_of_reception(content, topic);
  RecordedStamps stamps{{}, std::move(recorded.received)};
  for (const BagMessage& message : recorded.messages) stamps.stamps.push_back(stamp_of(content, message));
  RestoredTimes restored = restore_times(stamps, other);
  TimedMessages timed{{}, restored.corrections, restored.clock, {}};
  for (std::size_t i = 0; i < restored.items.size(); ++i) {
    timed.messages.push_back({restored.times[i], std::move(recorded.messages[restored.items[i]])});
  }
  timed.warnings =
      describe(timed.corrections, {names.place + ": " + content.topics[topic].name, names.kind, names.counted});
  return timed;
}

}  // namespace byre
