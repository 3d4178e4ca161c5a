#pragma once

#include "byre/io/recording/recording_index.h"
#include "byre/recording.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Indices of a recording's frames in the range, in order. Throws InputError with the path if there are none.
// Precondition: times ascend and are not empty.
std::vector<std::size_t> frames_in_range(const std::vector<Timestamp>& times, const FrameRange& range,
                                         const std::filesystem::path& path);

// Kinds of images of a recording, except those of the left camera.
struct ExtraImages {
  bool right = false;
  bool depth = false;
};

// The calibration of the chosen cameras. If the right camera alone is chosen, it becomes the left one. Throws
// InputError with the path if the recording lacks the camera.
CalibrationWithSource choose_calibration(const CalibrationWithSource& calibration, const ExtraImages& extra,
                                         const std::optional<CameraChoice>& choice, const std::filesystem::path& path);

// Kinds of images that at least one frame has.
ExtraImages extra_images_of(const RecordingIndex& index);

// The index reduced to the chosen cameras and their images. extra: of the whole recording. For the right camera alone,
// frames without its image are dropped.
RecordingIndex choose_camera(RecordingIndex index, const ExtraImages& extra, const std::optional<CameraChoice>& choice,
                             const std::filesystem::path& path);

// Throws InputError if the size of images differs from the calibration. place: of the size in the calibration.
void require_calibrated_size(int width, int height, const Camera& camera, const std::string& place);

// Syntax of command lines and protocols for frames and cameras of a recording.

// "FIRST:END", END exclusive; either may be omitted. Empty for anything else, and for an empty range.
std::optional<FrameRange> parse_frames(std::string_view text);

// One of stereo, left, right and rgbd; empty for anything else.
std::optional<CameraChoice> parse_camera(std::string_view text);

// Range of frame rates that may be given, Hz.
inline constexpr double kLowestFrameRate = 0.01, kHighestFrameRate = 10'000.0;

}  // namespace byre
