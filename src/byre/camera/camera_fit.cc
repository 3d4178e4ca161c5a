#include "byre/camera/camera_fit.h"

#include "byre/input_error.h"

#include <fmt/core.h>

namespace byre {
namespace {

void require_size(const Camera& camera, const CaptureThread& capture, const std::string& place) {
  if (camera.width == capture.width() && camera.height == capture.height()) return;
  throw InputError(place,
                   fmt::format("is for images of {} x {} pixels, but the camera delivers {} x {}", camera.width,
                               camera.height, capture.width(), capture.height()),
                   "set the camera to that size (--size), or calibrate it at this size");
}

}  // namespace

void request_calibrated_size(const Calibration& calibration, LiveCameraOptions& options) {
  if (options.request.width) return;
  options.request.width = calibration.left.width * (options.side_by_side ? 2 : 1);
  options.request.height = calibration.left.height;
}

void require_fit(const Calibration& calibration, const CaptureThread& capture, const std::string& place) {
  if (calibration.right && !capture.has_right()) {
    throw InputError(place, "is of a pair, but one camera is given",
                     "give the right camera's device too, or --side-by-side if its images contain both");
  }
  if (!calibration.right && capture.has_right()) {
    throw InputError(place, "is of one camera, but two are given", "give the calibration of the pair");
  }
  require_size(calibration.left, capture, place);
  if (calibration.right) require_size(calibration.right->camera, capture, place);
}

}  // namespace byre
