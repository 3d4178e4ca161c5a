#pragma once

#include "byre/trajectory.h"

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace byre {

// Whether the name's extension is that of an image file.
bool has_image_name(const std::filesystem::path& path);

// The image files right in a folder, in natural order; empty when there is no such folder.
std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder);

// Natural order, in which the digits of a name count as numbers: frame9 comes before frame10.
bool comes_before(std::string_view name, std::string_view other);

// The time that each file's name is: nanoseconds ("1403636584763555584.png") or seconds with a decimal point
// ("1305031102.175304.png"). Empty unless all names are times of one kind; whole numbers that grow by less than 0.1 ms
// from one to the next, taken as nanoseconds, are numbers of frames. Precondition: files are in natural order.
std::optional<std::vector<Timestamp>> times_in_names(const std::vector<std::filesystem::path>& files);

// The time in the name of one file alone, whose number is taken for nanoseconds where these reach beyond the first
// years of any clock (17 digits).
std::optional<Timestamp> time_in_name(const std::filesystem::path& file);

// Times of so many frames at a steady rate, the first at zero. Precondition: frame_rate_hz > 0.
std::vector<Timestamp> steady_times(std::size_t count, double frame_rate_hz);

}  // namespace byre
