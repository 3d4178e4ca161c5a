#include "byre/frame_report.h"

#include "byre/base/enum_names.h"

namespace byre {

std::string_view to_string(InputFault fault) {
  return name_among<InputFault::after_finishing>(
      {"none", "frame after a gap", "right image is missing", "right image has another time stamp",
       "depth image is missing", "depth image has another time stamp", "no image",
       "image does not have the calibrated size", "image has the wrong format", "features are invalid",
       "time stamp repeats the previous frame", "time stamp is before the previous frame",
       "frame after finishing the map"},
      fault);
}

}  // namespace byre
