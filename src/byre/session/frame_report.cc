#include "byre/frame_report.h"

namespace byre {

std::string_view to_string(InputFault fault) {
  switch (fault) {
    case InputFault::none:
      return "none";
    case InputFault::after_gap:
      return "comes after a gap";
    case InputFault::missing_right:
      return "right image is missing";
    case InputFault::late_right:
      return "right image is of another time";
    case InputFault::missing_depth:
      return "depth image is missing";
    case InputFault::late_depth:
      return "depth image is of another time";
    case InputFault::no_image:
      return "no image";
    case InputFault::wrong_size:
      return "image is not of the calibrated size";
    case InputFault::wrong_format:
      return "image is of a format that does not fit";
    case InputFault::wrong_features:
      return "features that no camera sees";
    case InputFault::repeated_time:
      return "time of the frame before";
    case InputFault::out_of_order:
      return "earlier than the frame before";
    case InputFault::after_finishing:
      return "comes after the map was finished";
  }
  return "";
}

}  // namespace byre
