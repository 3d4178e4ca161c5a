#include "byre/system/input_check.h"

#include "byre/features/image_view.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace byre {
namespace {

InputFault fault_of_picture(const ImageView& view, int width, int height, bool wants_depth) {
  if (view.data == nullptr) return InputFault::no_image;
  if (is_depth(view.format) != wants_depth) return InputFault::wrong_format;
  const bool fits = view.width == width && view.height == height && is_sound(view);
  return fits ? InputFault::none : InputFault::wrong_size;
}

InputFault fault_of_picture(const ImageView& view, const Camera& camera, bool wants_depth = false) {
  return fault_of_picture(view, camera.width, camera.height, wants_depth);
}

// The first of them that drops the frame, else the first there is.
InputFault worst_of(std::initializer_list<InputFault> faults) {
  for (const InputFault fault : faults) {
    if (is_dropped(fault)) return fault;
  }
  const auto* const found = std::ranges::find_if(faults, [](InputFault fault) { return fault != InputFault::none; });
  return found != faults.end() ? *found : InputFault::none;
}

}  // namespace

InputFault InputCheck::fault_of_time(Timestamp time) const {
  if (!last_time_) return InputFault::none;
  if (time == *last_time_) return InputFault::repeated_time;
  if (time < *last_time_) return InputFault::out_of_order;
  return to_seconds(time - *last_time_) > options_.max_gap ? InputFault::after_gap : InputFault::none;
}

InputFault InputCheck::fault_of(const CameraImages& images) const {
  InputFault right = InputFault::none, depth = InputFault::none;
  if (calibration_.right) {
    right = images.right && images.right->data != nullptr ? fault_of_picture(*images.right, calibration_.right->camera)
                                                          : InputFault::missing_right;
    const bool is_late = right == InputFault::none &&
                         std::abs(to_seconds(images.right->time - images.left.time)) > options_.max_pair_difference;
    if (is_late) right = InputFault::late_right;
  }
  if (calibration_.depth) {
    depth = images.depth && images.depth->data != nullptr
                ? fault_of_picture(*images.depth, calibration_.depth->camera.value_or(calibration_.left), true)
                : InputFault::missing_depth;
  }
  return worst_of({fault_of_picture(images.left, calibration_.left), right, depth, fault_of_time(images.left.time)});
}

InputFault InputCheck::note(const CameraImages& images) {
  const InputFault fault = note(fault_of(images));
  if (!is_dropped(fault)) last_time_ = images.left.time;
  return fault;
}

InputFault InputCheck::note(const Frame& frame) {
  const InputFault fault = note(frame.features ? fault_of_time(frame.time) : InputFault::no_image);
  if (!is_dropped(fault)) last_time_ = frame.time;
  return fault;
}

InputFault InputCheck::note(InputFault fault) {
  ++frames_;
  ++counts_[static_cast<std::size_t>(fault)];
  return last_ = fault;
}

}  // namespace byre
