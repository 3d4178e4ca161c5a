#include "byre/io/recording/bag_frames.h"

#include "byre/io/recording/bag_image.h"
#include "byre/io/recording/timed_files.h"
#include "byre/io/recording/timed_messages.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

std::vector<Timestamp> times_of(const std::vector<TimedMessage>& messages) {
  std::vector<Timestamp> times;
  for (const TimedMessage& each : messages) times.push_back(each.time);
  return times;
}

std::string in_ms(Timestamp time) {
  return fmt::format("{:g} ms", 1e3 * to_seconds(time));
}

// Adds right images to the frames. Returns warnings of images without a partner. Preconditions: frames have left images
// only, and there are right ones.
std::vector<std::string> add_right(std::vector<BagFrame>& frames, const std::vector<TimedMessage>& right,
                                   Timestamp tolerance, const std::string& place) {
  std::vector<Timestamp> times;
  for (const BagFrame& frame : frames) times.push_back(frame.time);
  const std::vector<Timestamp> right_times = times_of(right);
  const auto partners = match_by_time(times, right_times, tolerance);
  std::vector<bool> is_used(right.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!partners[i]) continue;
    frames[i].right = right[*partners[i]].message;
    is_used[*partners[i]] = true;
  }
  const auto alone = static_cast<std::size_t>(std::ranges::count(partners, std::optional<std::size_t>()));
  const auto unused = static_cast<std::size_t>(std::ranges::count(is_used, false));
  if (alone == frames.size()) throw no_pairs_error(place, times, right_times, tolerance);
  if (alone + unused == 0) return {};
  return {place + ": " + std::to_string(alone) + " of " + std::to_string(frames.size()) +
          " left images have no right image within " + in_ms(tolerance) + ", " + std::to_string(unused) + " of " +
          std::to_string(right.size()) + " right images have no left image"};
}

}  // namespace

BagFrames bag_frames(const BagContent& content, const ImageTopics& topics, const std::string& place,
                     Timestamp tolerance) {
  constexpr double kSameFrame = 0.4;  // largest difference between the receive times of a pair, intervals
  const TimedMessages left = timed_messages(content, topics.left, {place, "image", "frame"});
  BagFrames result{{}, left.corrections, left.clock, left.warnings};
  const std::string left_place = place + ": " + content.topics[topics.left].name;
  require_times(left.messages.size(), left.corrections.repeated, left_place);
  for (const TimedMessage& each : left.messages) result.frames.push_back({each.time, each.message});
  if (!topics.right) return result;
  const TimedMessages right = timed_messages(content, *topics.right, {place, "image", "frame"}, left.clock);
  result.warnings.insert(result.warnings.end(), right.warnings.begin(), right.warnings.end());
  if (left.clock.source == TimeSource::receive_times) {
    tolerance = std::max(tolerance, from_seconds(kSameFrame * to_seconds(left.clock.interval)));
  }
  const std::vector<std::string> alone = add_right(result.frames, right.messages, tolerance, place);
  result.warnings.insert(result.warnings.end(), alone.begin(), alone.end());
  return result;
}

}  // namespace byre
