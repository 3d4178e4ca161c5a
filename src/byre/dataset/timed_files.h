#pragma once

#include "byre/dataset/recording_index.h"

#include <filesystem>
#include <string>
#include <vector>

namespace byre {

// An image file and when it was taken.
struct TimedFile {
  Timestamp time{};
  std::filesystem::path path;
};

std::vector<std::filesystem::path> paths_of(const std::vector<TimedFile>& files);

// The frames of the left images, each with the right one taken within 2 ms, where there is one. Precondition: both
// ascend in time.
std::vector<FrameFiles> frames_of(const std::vector<TimedFile>& left, const std::vector<TimedFile>& right);

// Throws InputError with this place when no frame has a right image.
void require_pairs(const std::vector<FrameFiles>& frames, const std::string& place);

}  // namespace byre
