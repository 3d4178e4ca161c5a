#include "start_cases.h"

namespace byre {
namespace {

RecordingName barn(const std::string& name) {
  return {Source::barn, name};
}

MapChoice map_of(const std::string& name) {
  return {{barn(name)}};
}

// The first 13 s of a visit: along one side of the alley, up to the turn.
MapChoice one_way_map_of(const std::string& name) {
  MapChoice map = map_of(name);
  map.recipe.range.last = 130;
  return map;
}

std::vector<StartCase> make_start_cases() {
  const StartPlan all_along{.every_s = 2.0, .length_s = 6.0};
  const StartPlan way_back{.every_s = 1.0, .length_s = 4.0, .from_s = 13.0};
  const OpenOptions no_wheels{};
  OpenOptions left{.use_wheels = true, .use_gyroscope = true};
  left.camera = CameraChoice::left;
  std::vector<StartCase> cases;
  for (const std::string size : {"320x240", "376x240", "640x480", "1280x720"}) {
    cases.push_back({"images_of_" + size, map_of("visit_1_" + size), "visit_2_" + size, all_along});
    cases.push_back({"one_way_map_" + size, one_way_map_of("visit_1_" + size), "visit_1_" + size, way_back});
  }
  cases.push_back({"one_way_map_other_day", one_way_map_of("visit_1_376x240"), "visit_2_376x240", all_along});
  const MapChoice whole = map_of("visit_1");
  cases.push_back({"gate_open", whole, "gate_open", all_along, no_wheels});
  cases.push_back({"gate_open_wheels", whole, "gate_open", all_along});
  cases.push_back({"gate_open_one_camera", whole, "gate_open", all_along, left});
  cases.push_back({"swapped_things", whole, "swapped_things", all_along, no_wheels});
  // The robot passes bays that are missing in the map, among mapped ones that look alike.
  MapChoice with_hole = whole;
  with_hole.hole = Span{4.0, 10.0};
  cases.push_back({"repeated_bays",
                   with_hole,
                   "visit_1",
                   {.every_s = 0.5, .length_s = 3.0, .from_s = 4.0, .to_s = 8.0},
                   no_wheels});
  // Further image sizes, maps of one way, moved things, and the open gate with a stereo camera.
  for (StartCase& start_case : cases) {
    const std::string& name = start_case.name;
    start_case.is_long_run = name.ends_with("_376x240") || name.ends_with("_640x480") || name.ends_with("_1280x720") ||
                             name.starts_with("one_way_map_") || name == "swapped_things" || name == "gate_open" ||
                             name == "gate_open_wheels";
  }
  return cases;
}

}  // namespace

const std::vector<StartCase>& start_cases() {
  static const std::vector<StartCase> cases = make_start_cases();
  return cases;
}

std::optional<std::string> what_is_missing(const StartCase& start_case) {
  for (const RecordingName& name : {start_case.map.recipe.recording, barn(start_case.mission)}) {
    if (!find(name)) return why_missing(name);
  }
  return std::nullopt;
}

StartTotals run(const StartCase& start_case, const AlignedMap& known,
                const std::function<void(const StartedMission&)>& each) {
  const RecordingName mission = barn(start_case.mission);
  const auto recording = open_recording(find(mission).value(), {}, start_case.open);
  return run_starts(*recording, truth_of(mission), known.map, known.truth_from_map, start_case.map.recipe.imperfection,
                    start_case.plan, each);
}

}  // namespace byre
