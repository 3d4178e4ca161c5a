#pragma once

#include "byre/io/bag/bag.h"
#include "byre/io/recording/bag_topics.h"
#include "byre/io/recording/restored_times.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

struct BagFrame {
  Timestamp time{};
  BagMessage left;
  std::optional<BagMessage> right{};
};

struct BagFrames {
  std::vector<BagFrame> frames;
  TimeCorrections corrections;        // corrections of the left images
  SensorClock clock;                  // clock of the left images
  std::vector<std::string> warnings;  // with counts of corrections, and of images without a partner
};

// Frames of the left images in order of time (timed_messages), each with the right image whose time differs by at most
// the tolerance. place: name of the bag in warnings. Throws InputError if no right image has a left partner, and if all
// left images have one time stamp.
BagFrames bag_frames(const BagContent& content, const ImageTopics& topics, const std::string& place,
                     Timestamp tolerance);

}  // namespace byre
