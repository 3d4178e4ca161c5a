#pragma once

#include "byre/bag/bag.h"
#include "byre/body_motion.h"
#include "byre/dataset/restored_times.h"
#include "byre/recording.h"

#include <string>
#include <string_view>
#include <vector>

namespace byre {

struct BagMotion {
  MotionSamples samples;
  std::vector<std::string> warnings;
};

// Whether messages of a type are needed for what the options ask for, beside images.
bool is_of_motion(std::string_view type, const OpenOptions& options);

// What wheels and a gyroscope told, at the times of the messages' headers:
//   wheels      nav_msgs/Odometry, its poses or, where they never change, its twists; geometry_msgs/TwistStamped or
//               TwistWithCovarianceStamped; of the topic that the options name; or the file that they name
//   gyroscope   sensor_msgs/Imu of the topic that they name; of the only one, where they ask for a gyroscope alone
// place: name of the bag in errors and warnings. Warnings count damaged and non-finite messages, and corrections of
// times. images: clock of the left images. Throws InputError, with a list of topics of that kind, for an absent topic
// and if several topics qualify.
BagMotion read_bag_motion(Bag& bag, const OpenOptions& options, const std::string& place,
                          const SensorClock& images = {});

}  // namespace byre
