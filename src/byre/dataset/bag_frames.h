#pragma once

#include "byre/bag/bag.h"
#include "byre/dataset/bag_topics.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// The messages of the images of a frame.
struct BagFrame {
  Timestamp time{};
  BagMessage left;
  std::optional<BagMessage> right{};
};

struct BagFrames {
  std::vector<BagFrame> frames;
  std::vector<std::string> warnings;  // counts of what is out of order, left out or alone
};

// Frames of the left images, strictly increasing in the time of their headers, each with the right image taken with it.
// place: how warnings name the bag. Throws InputError when there are right images and none belongs to a left one.
BagFrames bag_frames(const BagContent& content, const ImageTopics& topics, const std::string& place);

}  // namespace byre
