#pragma once

#include "byre/dataset/recording_index.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Which of a recording's frames are in the range, in order. Throws InputError, naming the path, when none is.
// Precondition: times ascend and are not empty.
std::vector<std::size_t> frames_in_range(const std::vector<Timestamp>& times, const FrameRange& range,
                                         const std::filesystem::path& path);

// The calibration of the cameras that are asked for, with the right one, where that is asked for alone, as the left.
// has_pairs: whether there are images of both. Throws InputError, naming the path, when there is no such camera.
PlacedCalibration choose_calibration(const PlacedCalibration& calibration, bool has_pairs,
                                     const std::optional<CameraChoice>& choice, const std::filesystem::path& path);

// Whether any frame has images of both cameras.
bool has_pairs(const RecordingIndex& index);

// The calibration chosen so, and the images that belong to it; has_pairs is that of the whole recording. Of the right
// camera alone, frames without its image are left out.
RecordingIndex choose_camera(RecordingIndex index, bool has_pairs, const std::optional<CameraChoice>& choice,
                             const std::filesystem::path& path);

// Throws InputError when images are of another size than calibrated; place is that of the size in the calibration.
void require_calibrated_size(int width, int height, const Camera& camera, const std::string& place);

}  // namespace byre
