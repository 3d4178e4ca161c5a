#pragma once

#include "byre/body_motion.h"
#include "byre/io/bag/bag.h"
#include "byre/io/recording/restored_times.h"
#include "byre/recording.h"

#include <string>
#include <string_view>
#include <vector>

namespace byre {

struct BagMotion {
  MotionSamples samples;
  std::vector<std::string> warnings;
};

// Whether the options require messages of this type, other than images.
bool is_motion_type(std::string_view type, const OpenOptions& options);

// Samples of wheels and gyroscope, with header times:
//   wheels      nav_msgs/Odometry: its poses, or its twists if the poses never change; geometry_msgs/TwistStamped or
//               TwistWithCovarianceStamped. From the topic or the file that the options name.
//   gyroscope   sensor_msgs/Imu. From the topic that the options name; from the only one if they name none.
// place: name of the bag in errors and warnings. Warnings count damaged and non-finite messages, and corrections of
// times. images: clock of the left images. Throws InputError, with a list of topics of that kind, for an absent topic
// and if several topics qualify.
BagMotion read_bag_motion(Bag& bag, const OpenOptions& options, const std::string& place,
                          const SensorClock& images = {});

}  // namespace byre
