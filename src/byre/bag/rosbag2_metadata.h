#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace byre {

// The file of a rosbag2 folder that says what is in it.
inline constexpr const char* kRosbag2Metadata = "metadata.yaml";
inline constexpr const char* kRosbag2Key = "rosbag2_bagfile_information";

// Files of the bag in a folder: those that its metadata.yaml names, in order, or all that can be some where there is
// none. What is missing or makes no sense is told in the warnings.
struct Rosbag2Files {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> warnings{};
};

Rosbag2Files rosbag2_files(const std::filesystem::path& folder);

// By the name, whether a file can be one of a rosbag2 folder: .mcap, .db3, .mcap.zstd, .db3.zstd.
bool has_rosbag2_name(const std::filesystem::path& file);

}  // namespace byre
