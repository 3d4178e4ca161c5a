#include "byre/slam/system/input_check.h"

#include "byre/features/image_view.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace byre {
namespace {

InputFault fault_of_picture(const ImageView& view, const Camera& camera, bool wants_depth = false) {
  if (view.data == nullptr) return InputFault::no_image;
  if (is_depth(view.format) != wants_depth) return InputFault::wrong_format;
  const bool fits = view.width == camera.width && view.height == camera.height && is_sound(view);
  return fits ? InputFault::none : InputFault::wrong_size;
}

bool has_data(const std::optional<ImageView>& view) {
  return view && view->data != nullptr;
}

// First fault that drops the frame, else the first fault.
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
  return to_seconds(time) - to_seconds(*last_time_) > options_.max_gap ? InputFault::after_gap : InputFault::none;
}

// Compares seconds, as the difference of invalid times may overflow.
bool InputCheck::is_simultaneous(const ImageView& view, const ImageView& left) const {
  return view.time == Timestamp{} ||
         std::abs(to_seconds(view.time) - to_seconds(left.time)) <= options_.max_pair_difference;
}

InputFault InputCheck::fault_of_right(const CameraImages& images) const {
  if (!calibration_.right) return InputFault::none;
  if (!has_data(images.right)) return InputFault::missing_right;
  const InputFault fault = fault_of_picture(*images.right, calibration_.right->camera);
  return fault != InputFault::none || is_simultaneous(*images.right, images.left) ? fault : InputFault::late_right;
}

InputFault InputCheck::fault_of_depth(const CameraImages& images) const {
  if (!calibration_.depth) return InputFault::none;
  if (!has_data(images.depth)) return InputFault::missing_depth;
  const InputFault fault =
      fault_of_picture(*images.depth, calibration_.depth->camera.value_or(calibration_.left), true);
  return fault != InputFault::none || is_simultaneous(*images.depth, images.left) ? fault : InputFault::late_depth;
}

InputFault InputCheck::fault_of(const Frame& frame) const {
  if (!frame.features) return InputFault::no_image;
  const bool is_sound = std::ranges::all_of(frame.features->keypoints(),
                                            [&](const Keypoint& keypoint) { return fault_in(keypoint, rig_).empty(); });
  return is_sound ? fault_of_time(frame.time) : InputFault::wrong_features;
}

InputFault InputCheck::note(const CameraImages& images) {
  const InputFault right = fault_of_right(images), depth = fault_of_depth(images);
  is_right_valid_ = calibration_.right && right == InputFault::none;
  is_depth_valid_ = calibration_.depth && depth == InputFault::none;
  const InputFault left = fault_of_picture(images.left, calibration_.left);
  const InputFault fault = note(worst_of({left, right, depth, fault_of_time(images.left.time)}));
  if (!is_dropped(fault)) last_time_ = images.left.time;
  return fault;
}

InputFault InputCheck::note(const Frame& frame) {
  const InputFault fault = note(fault_of(frame));
  if (!is_dropped(fault)) last_time_ = frame.time;
  return fault;
}

InputFault InputCheck::note(InputFault fault) {
  ++frames_;
  ++counts_[static_cast<std::size_t>(fault)];
  return last_ = fault;
}

}  // namespace byre
