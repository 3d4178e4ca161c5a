#pragma once

#include "byre/io/colmap/colmap_model.h"

#include <filesystem>

namespace byre {

// The three files of a model, read one at a time; read_colmap_model checks references between them. They throw the same
// InputError.

std::map<std::uint32_t, ColmapCamera> read_colmap_cameras_text(const std::filesystem::path& path);
std::map<std::uint32_t, ColmapImage> read_colmap_images_text(const std::filesystem::path& path);
std::map<std::uint64_t, ColmapPoint> read_colmap_points_text(const std::filesystem::path& path);

std::map<std::uint32_t, ColmapCamera> read_colmap_cameras_binary(const std::filesystem::path& path);
std::map<std::uint32_t, ColmapImage> read_colmap_images_binary(const std::filesystem::path& path);
std::map<std::uint64_t, ColmapPoint> read_colmap_points_binary(const std::filesystem::path& path);

// The rotation of a quaternion whose length is 1 within 1 %, the precision of files; else empty.
std::optional<Eigen::Quaterniond> colmap_rotation(double w, double x, double y, double z);

void write_colmap_text(const ColmapModel& model, const std::filesystem::path& folder);
void write_colmap_binary(const ColmapModel& model, const std::filesystem::path& folder);

}  // namespace byre
