#include "byre/dataset/bag_frames.h"

#include "byre/dataset/bag_image.h"
#include "byre/dataset/timed_files.h"
#include "byre/dataset/timed_messages.h"
#include "byre/geometry/median.h"
#include "byre/input_error.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

std::vector<Timestamp> times_of(const std::vector<TimedMessage>& messages) {
  std::vector<Timestamp> times;
  for (const TimedMessage& each : messages) times.push_back(each.time);
  return times;
}

// The median of the times from each image to the nearest one of the other camera, ms.
double usual_difference_ms(const std::vector<Timestamp>& left, const std::vector<Timestamp>& right) {
  std::vector<double> differences;
  for (const Timestamp time : left) {
    const auto after = std::ranges::lower_bound(right, time);
    Timestamp nearest = Timestamp::max();
    if (after != right.end()) nearest = *after - time;
    if (after != right.begin()) nearest = std::min(nearest, time - *std::prev(after));
    differences.push_back(1e3 * to_seconds(nearest));
  }
  return median(std::move(differences));
}

// Gives the frames their right images; tells how many images have no partner. Preconditions: frames are those of the
// left images alone, and there are right ones.
std::vector<std::string> add_right(std::vector<BagFrame>& frames, const std::vector<TimedMessage>& right,
                                   const std::string& place) {
  std::vector<Timestamp> times;
  for (const BagFrame& frame : frames) times.push_back(frame.time);
  const auto partners = partners_in_time(times, times_of(right));
  std::vector<bool> is_used(right.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!partners[i]) continue;
    frames[i].right = right[*partners[i]].message;
    is_used[*partners[i]] = true;
  }
  const auto alone = static_cast<std::size_t>(std::ranges::count(partners, std::optional<std::size_t>()));
  const auto unused = static_cast<std::size_t>(std::ranges::count(is_used, false));
  if (alone == frames.size()) {
    throw InputError(place,
                     "no right image was taken within 2 ms of any left one; the nearest is off by " +
                         std::to_string(usual_difference_ms(times, times_of(right))) + " ms as a rule",
                     "check that both cameras are triggered together and use one clock, or take one: --camera left");
  }
  if (alone + unused == 0) return {};
  return {place + ": " + std::to_string(alone) + " of " + std::to_string(frames.size()) +
          " left images have no right one taken within 2 ms, " + std::to_string(unused) + " of " +
          std::to_string(right.size()) + " right images no left one"};
}

}  // namespace

BagFrames bag_frames(const BagContent& content, const ImageTopics& topics, const std::string& place) {
  BagFrames result;
  const auto tell = [&result](const std::vector<std::string>& warnings) {
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
  };
  const TimedMessages left = timed_messages(content, topics.left, {place, "images"});
  tell(left.warnings);
  for (const TimedMessage& each : left.messages) result.frames.push_back({each.time, each.message});
  if (!topics.right) return result;
  const TimedMessages right = timed_messages(content, *topics.right, {place, "images"});
  tell(right.warnings);
  tell(add_right(result.frames, right.messages, place));
  return result;
}

}  // namespace byre
