#pragma once

#include "byre/trajectory.h"

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace byre {

bool has_image_name(const std::filesystem::path& path);

// Image files directly in a folder, in natural order; empty if there is no such folder.
std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder);

// Natural order, with digits compared as numbers: frame9 precedes frame10.
bool natural_less(std::string_view name, std::string_view other);

// Times from file names: nanoseconds ("1403636584763555584.png") or seconds with a decimal point
// ("1305031102.175304.png"). Empty unless all names are times of one kind. Whole numbers with steps below 0.1 ms,
// read as nanoseconds, are frame numbers. Precondition: files are in natural order.
std::optional<std::vector<Timestamp>> times_in_names(const std::vector<std::filesystem::path>& files);

// Time from the name of a single file. Whole numbers count as nanoseconds from 17 digits on, beyond the first years of
// any clock.
std::optional<Timestamp> time_in_name(const std::filesystem::path& file);

// Times at a constant rate, the first one zero. Precondition: frame_rate_hz > 0.
std::vector<Timestamp> uniform_times(std::size_t count, double frame_rate_hz);

}  // namespace byre
