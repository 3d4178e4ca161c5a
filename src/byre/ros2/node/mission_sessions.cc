#include "byre/ros2/node/mission_sessions.h"

#include "byre/input_error.h"

#include <algorithm>

#include <fmt/chrono.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".session";

}  // namespace

fs::path beside(const fs::path& map, const std::string& name, const fs::path& extension) {
  fs::path path = map.parent_path() / map.stem();
  path += "." + name;
  path += extension;
  return path;
}

fs::path session_file(const fs::path& map, std::chrono::system_clock::time_point time) {
  return beside(map, fmt::format("{:%Y%m%dT%H%M%S}Z", fmt::gmtime(time)), kExtension);
}

fs::path proposed_map(const fs::path& map) {
  return beside(map, "proposed", map.extension());
}

std::vector<fs::path> waiting_sessions(const fs::path& map) {
  constexpr std::size_t kMost = 10;
  const std::string begin = map.stem().string() + ".";
  const std::size_t length = session_file(map, {}).filename().string().size();
  std::error_code error, ignored;  // a file may be gone meanwhile
  fs::directory_iterator entry(map.has_parent_path() ? map.parent_path() : ".", error);
  std::vector<fs::path> sessions;
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const bool is_session = name.starts_with(begin) && name.ends_with(kExtension) && name.size() == length;
    if (is_session && entry->is_regular_file(ignored)) sessions.push_back(map.parent_path() / name);
  }
  if (error)
    throw InputError(map.string(), "has a folder that cannot be listed: " + error.message(),
                     "let the user of byre read it");
  std::ranges::sort(sessions);
  for (; sessions.size() > kMost; sessions.erase(sessions.begin())) fs::remove(sessions.front(), ignored);
  return sessions;
}

}  // namespace byre
