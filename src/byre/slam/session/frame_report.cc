#include "byre/frame_report.h"

namespace byre {

std::string_view to_string(InputFault fault) {
  switch (fault) {
    case InputFault::none:
      return "none";
    case InputFault::after_gap:
      return "frame after a gap";
    case InputFault::missing_right:
      return "right image is missing";
    case InputFault::late_right:
      return "right image has another time stamp";
    case InputFault::missing_depth:
      return "depth image is missing";
    case InputFault::late_depth:
      return "depth image has another time stamp";
    case InputFault::no_image:
      return "no image";
    case InputFault::wrong_size:
      return "image does not have the calibrated size";
    case InputFault::wrong_format:
      return "image has the wrong format";
    case InputFault::wrong_features:
      return "features are invalid";
    case InputFault::repeated_time:
      return "time stamp repeats the previous frame";
    case InputFault::out_of_order:
      return "time stamp is before the previous frame";
    case InputFault::after_finishing:
      return "frame after finishing the map";
  }
  return "";
}

}  // namespace byre
