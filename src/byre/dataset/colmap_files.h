#pragma once

#include "byre/dataset/colmap_model.h"

#include <filesystem>

namespace byre {

// The three files of a model, one at a time; what they say of each other is checked by read_colmap_model. They throw
// InputError as that does.

std::map<std::uint32_t, ColmapCamera> read_colmap_cameras_text(const std::filesystem::path& path);
std::map<std::uint32_t, ColmapImage> read_colmap_images_text(const std::filesystem::path& path);
std::map<std::uint64_t, ColmapPoint> read_colmap_points_text(const std::filesystem::path& path);

std::map<std::uint32_t, ColmapCamera> read_colmap_cameras_binary(const std::filesystem::path& path);
std::map<std::uint32_t, ColmapImage> read_colmap_images_binary(const std::filesystem::path& path);
std::map<std::uint64_t, ColmapPoint> read_colmap_points_binary(const std::filesystem::path& path);

// A rotation whose quaternion is of unit length to 1 %, as files have it; else empty.
std::optional<Eigen::Quaterniond> colmap_rotation(double w, double x, double y, double z);

void write_colmap_text(const ColmapModel& model, const std::filesystem::path& folder);
void write_colmap_binary(const ColmapModel& model, const std::filesystem::path& folder);

}  // namespace byre
