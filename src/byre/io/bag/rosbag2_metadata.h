#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace byre {

// Metadata file of a rosbag2 folder.
inline constexpr const char* kRosbag2Metadata = "metadata.yaml";
inline constexpr const char* kRosbag2Key = "rosbag2_bagfile_information";

// Files of the bag in a folder: those in its metadata.yaml, in order; without it, all files with a rosbag2 name.
// Warnings list missing and invalid entries.
struct Rosbag2Files {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> warnings{};
};

Rosbag2Files rosbag2_files(const std::filesystem::path& folder);

// Whether the name is that of a file in a rosbag2 folder: .mcap, .db3, .mcap.zstd, .db3.zstd.
bool has_rosbag2_name(const std::filesystem::path& file);

}  // namespace byre
