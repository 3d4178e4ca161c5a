// AprilTags.

#include "bindings.h"

#include "byre/tag_file.h"

#include <string>

namespace byre::python {

void bind_tags(py::module_& module) {
  py::class_<Tag>(module, "Tag", "Printed AprilTag, see read_tags.")
      .def_property_readonly(
          "name", [](const Tag& tag) { return to_string(tag.id); }, "Family and number, such as 'tag36h11 7'.")
      .def_readonly("size", &Tag::size, "Side of the square between the detected corners, metres.")
      .def_property_readonly(
          "position", [](const Tag& tag) { return tag.survey ? std::optional(tag.survey->position) : std::nullopt; },
          "Surveyed centre on the floor plan, metres, z above the floor; None if not surveyed.")
      .def("__repr__", [](const Tag& tag) { return "<Tag " + to_string(tag.id) + ">"; });
  py::class_<MappedTag>(module, "MappedTag", "AprilTag of a Map.")
      .def_property_readonly(
          "name", [](const MappedTag& tag) { return to_string(tag.id); }, "Family and number, such as 'tag36h11 7'.")
      .def_readonly("size", &MappedTag::size, "Side of the square between the detected corners, lengths of the map.")
      .def_property_readonly(
          "map_from_tag", [](const MappedTag& tag) { return matrix_of(tag.map_from_tag); },
          "4x4. The tag's frame: origin in the centre, x right and y down as seen from the front, z into the wall.")
      .def_readonly("sigma", &MappedTag::sigma,
                    "Standard deviation of each coordinate of its position, lengths of the map.")
      .def("__repr__", [](const MappedTag& tag) { return "<MappedTag " + to_string(tag.id) + ">"; });
  module.def("read_tags", &read_tags, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
             "Reads a YAML file of AprilTags, list of Tag, see the reference page \"AprilTags\". Raises InputError for "
             "an invalid file, and if byre was built without libapriltag.\n"
             ">>> [tag.name for tag in byre.read_tags(\"tags.yaml\")]\n"
             "['tag36h11 3', 'tag36h11 7']");
}

}  // namespace byre::python
