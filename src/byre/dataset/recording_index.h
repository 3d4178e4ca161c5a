#pragma once

#include "byre/features/image.h"
#include "byre/geometry/camera.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace byre {

// Where the images of one frame are. A monocular frame, or one whose partner is lost, has no right image.
struct FrameFiles {
  Timestamp time{};
  std::filesystem::path left;
  std::optional<std::filesystem::path> right;
};

// What a recording consists of, before any image is wanted.
struct RecordingIndex {
  Calibration calibration;
  std::vector<FrameFiles> frames;  // strictly increasing in time
};

// The folder that holds cam0 in an EuRoC recording, given it or the one above; empty when there is none.
std::optional<std::filesystem::path> find_mav_folder(const std::filesystem::path& folder);

// Both throw InputError as open_recording says. Images of the two EuRoC cameras belong together when their time stamps
// differ by 2 ms at most; KITTI's by their number.
RecordingIndex index_euroc(const std::filesystem::path& folder);
RecordingIndex index_kitti(const std::filesystem::path& folder);

// The first image that can be decoded; throws InputError naming the folder when there is none.
Image first_readable(const std::vector<std::filesystem::path>& files);

}  // namespace byre
