#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace byre {

// Files beside a map, for updates of it. For barn.byre:
//   barn.20261129T013000Z.session   what a mission learned, until the map is updated by it
//   barn.proposed.byre              updated map
//   barn.previous.byre              former version of the map
// name: "proposed".
std::filesystem::path beside(const std::filesystem::path& map, const std::string& name,
                             const std::filesystem::path& extension);
std::filesystem::path session_file(const std::filesystem::path& map, std::chrono::system_clock::time_point time);
std::filesystem::path proposed_map(const std::filesystem::path& map);

// Sessions that wait for an update, oldest first. Removes the oldest if there are more than ten. Throws InputError if
// the folder cannot be listed.
std::vector<std::filesystem::path> waiting_sessions(const std::filesystem::path& map);

}  // namespace byre
