#pragma once

#include "byre/recording.h"

#include <memory>
#include <string>

namespace byre {

// The recording, or one that exchanges left and right or reverses the baseline where the images show that this is
// needed, with a warning. Frames of the first seconds decide: nearly all of them must contradict the pair as recorded
// and fit the other reading, by matches with a parallax that no worn calibration causes. place: of the recording, in
// the warning.
std::unique_ptr<Recording> with_fitting_pair(std::unique_ptr<Recording> recording, const std::string& place);

}  // namespace byre
