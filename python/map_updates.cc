// Updates of maps by missions.

#include "bindings.h"

#include "byre/map.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace byre::python {

void bind_map_updates(py::module_& module) {
  py::class_<MapUpdateResult>(module, "MapUpdateResult", "What an update of a map changed, or why there is none.")
      .def_property_readonly(
          "refusal",
          [](const MapUpdateResult& result) {
            return result.refusal.empty() ? std::nullopt : std::optional(result.refusal);
          },
          "Reason why the map stays as it is; None if the updated map was written.")
      .def_readonly("keyframes_added", &MapUpdateResult::keyframes_added, "Keyframes of new and changed places.")
      .def_readonly("points_added", &MapUpdateResult::points_added, "Points that the added keyframes observe.")
      .def_readonly("points_retired", &MapUpdateResult::points_retired, "Points removed as no longer there.")
      .def("__repr__", [](const MapUpdateResult& result) {
        if (!result.refusal.empty()) return "<MapUpdateResult refused: " + result.refusal + ">";
        return fmt::format("<MapUpdateResult {} keyframes, {} points added, {} points retired>", result.keyframes_added,
                           result.points_added, result.points_retired);
      });
  module.def(
      "update_map_file",
      [](const std::filesystem::path& map, const std::vector<std::filesystem::path>& sessions,
         const std::filesystem::path& output) { return update_map_file(map, sessions, output); },
      py::arg("map"), py::arg("sessions"), py::arg("output"), py::call_guard<py::gil_scoped_release>(),
      "Updates a map by sessions of missions on it, files of Slam.save_session, as \"byre update\": writes the new "
      "version to output unless no session fits or a place would be worse. Returns a MapUpdateResult. Takes seconds. "
      "Raises InputError if a file cannot be read or written, or is not of its kind.\n"
      ">>> mission.save_session(\"room.session\")\n"
      ">>> result = byre.update_map_file(path, [\"room.session\"], \"room_2.byre\")");
}

}  // namespace byre::python
