#pragma once

#include "byre/calibration.h"
#include "byre/camera/capture_thread.h"

#include <string>

namespace byre {

// Requests images of the calibrated size, unless the options request a size.
void request_calibrated_size(const Calibration& calibration, LiveCameraOptions& options);

// Throws InputError if the calibration has another number of cameras, or another image size. place: its file.
void require_fit(const Calibration& calibration, const CaptureThread& capture, const std::string& place);

}  // namespace byre
