#pragma once

#include "byre/dataset/recording_index.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// An image file and when it was taken.
struct TimedFile {
  Timestamp time{};
  std::filesystem::path path;
};

// For each time the number of the other one nearest to it, where that is within 2 ms. Precondition: both ascend.
std::vector<std::optional<std::size_t>> partners_in_time(const std::vector<Timestamp>& times,
                                                         const std::vector<Timestamp>& others);

// The frames of the left images, each with the right one taken within 2 ms, where there is one. Precondition: both
// ascend in time.
std::vector<FrameFiles> frames_of(const std::vector<TimedFile>& left, const std::vector<TimedFile>& right);

// Gives the frames their depth images: each image belongs to the frame nearest to it, when that is within 20 ms, and a
// frame takes the nearest of its own. Precondition: both ascend in time.
void add_depth(std::vector<FrameFiles>& frames, const std::vector<TimedFile>& depth);

// Throws InputError with this place when no frame has a right image.
void require_pairs(const std::vector<FrameFiles>& frames, const std::string& place);

}  // namespace byre
