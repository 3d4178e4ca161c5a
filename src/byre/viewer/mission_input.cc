#include "byre/viewer/mission_input.h"

#include "byre/base/regular_file.h"
#include "byre/input_error.h"

#include <array>
#include <fstream>

#include <nlohmann/json.hpp>

namespace byre {
namespace {

using nlohmann::json;

Verdict verdict_named(const std::string& name, const std::string& file) {
  for (const Verdict verdict : {Verdict::trusted, Verdict::degraded, Verdict::untrusted}) {
    if (name == to_string(verdict)) return verdict;
  }
  throw InputError(file, "has a frame with the unknown verdict \"" + name + "\"",
                   "write it again with byre run --stats");
}

Pose pose_of(const json& frame) {
  const auto position = frame.at("position_m").get<std::array<double, 3>>();
  const auto xyzw = frame.at("quaternion_xyzw").get<std::array<double, 4>>();
  return {Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]), {position[0], position[1], position[2]}};
}

PlanPath path_in_stats(const json& stats, const std::string& file) {
  PlanPath path;
  for (const json& frame : stats.at("frames")) {
    if (!frame.contains("position_m")) continue;
    path.map_from_body.push_back({Timestamp(frame.at("time_ns").get<std::int64_t>()), pose_of(frame)});
    path.verdicts.push_back(verdict_named(frame.at("health").at("verdict"), file));
  }
  return path;
}

}  // namespace

PlanPath load_mission(const std::filesystem::path& stats) {
  refuse_pipe(stats);
  std::ifstream file(stats);
  if (!file) throw InputError(stats.string(), "cannot be opened", "check the file name");
  try {
    const json content = json::parse(file);
    if (content.at("protocol").value("pose_frame", "map") != "map") {
      throw InputError(stats.string(), "has poses on the floor plan, not in the map",
                       "run the mission without --frame plan");
    }
    return path_in_stats(content, stats.string());
  } catch (const json::exception&) {
    throw InputError(stats.string(), "is not a statistics file of a mission", "give a file of byre run --stats");
  }
}

}  // namespace byre
