#pragma once

#include "byre/calibration.h"
#include "byre/camera/capture_thread.h"

#include <string>

namespace byre {

// Asks the devices for images of the calibrated size, unless another one is asked for.
void ask_for_size(const Calibration& calibration, LiveCameraOptions& options);

// Throws InputError when the calibration is not of such cameras: of another number, or of images of another size.
// place: its file.
void require_fit(const Calibration& calibration, const CaptureThread& capture, const std::string& place);

}  // namespace byre
