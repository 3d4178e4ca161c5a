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

// What images a recording holds beside those of the left camera.
struct BesideLeft {
  bool right = false;
  bool depth = false;
};

// The calibration of the cameras that are asked for, with the right one, where that is asked for alone, as the left.
// Throws InputError, naming the path, when there is no such camera.
PlacedCalibration choose_calibration(const PlacedCalibration& calibration, const BesideLeft& beside,
                                     const std::optional<CameraChoice>& choice, const std::filesystem::path& path);

// What any frame has.
BesideLeft images_beside_left(const RecordingIndex& index);

// The calibration chosen so, and the images that belong to it; beside is that of the whole recording. Of the right
// camera alone, frames without its image are left out.
RecordingIndex choose_camera(RecordingIndex index, const BesideLeft& beside, const std::optional<CameraChoice>& choice,
                             const std::filesystem::path& path);

// Throws InputError when images are of another size than calibrated; place is that of the size in the calibration.
void require_calibrated_size(int width, int height, const Camera& camera, const std::string& place);

}  // namespace byre
