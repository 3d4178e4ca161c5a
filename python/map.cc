// Maps, their queries and edits.

#include "byre/map.h"

#include "enums.h"

#include "byre/colmap.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace byre::python {
namespace {

// A map with what is made of it on first use. Arrays stay valid without the map.
struct CachedMap {
  explicit CachedMap(Map given) : map(std::move(given)) {}

  Map map;
  py::object keyframes, positions, covariances, grey_values, observation_counts, recording_counts;
  std::mutex mutex;  // of the localiser
  std::optional<Localiser> localiser;
  std::optional<Calibration> localised_by;  // calibration given to the localiser
};

using MapPointer = std::shared_ptr<CachedMap>;
using Numbers = std::vector<int>;

// Array that shares memory of its owner. Not writeable, as maps do not change.
template <typename Number>
py::array array_in(std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides, const Number* data,
                   const py::object& owner) {
  py::array_t<Number> array(std::move(shape), std::move(strides), data, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

// Takes the memory of items, each of which is an array of numbers of this shape.
template <typename Number, typename Item>
py::array array_of(std::vector<Item> items, const std::vector<py::ssize_t>& shape_of_item) {
  auto kept = std::make_unique<std::vector<Item>>(std::move(items));
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(kept->size())};
  shape.insert(shape.end(), shape_of_item.begin(), shape_of_item.end());
  std::vector<py::ssize_t> strides(shape.size(), sizeof(Number));
  for (std::size_t i = shape.size() - 1; i > 0; --i) strides[i - 1] = strides[i] * shape[i];
  const Number* const data = reinterpret_cast<const Number*>(kept->data());
  const py::capsule owner(kept.release(), [](void* memory) { delete static_cast<std::vector<Item>*>(memory); });
  return array_in<Number>(std::move(shape), std::move(strides), data, owner);
}

py::array ids_of(Numbers ids) {
  return array_of<int>(std::move(ids), {});
}

template <typename Make>
py::object cached(py::object& slot, Make make) {
  if (!slot) slot = make();
  return slot;
}

int checked(int id, int count, const char* kind) {
  if (id < 0 || id >= count) {
    throw py::index_error(std::string(kind) + " " + std::to_string(id) + " does not exist: there are " +
                          std::to_string(count));
  }
  return id;
}

// Ids of points from integers, or from a mask with an item for each point.
Numbers selected(const CachedMap& self, const py::object& given) {
  const py::array points = py::array::ensure(given);
  if (!points) throw py::error_already_set();
  const char kind = points.dtype().kind();
  const bool is_mask = kind == 'b' && points.ndim() == 1 && points.size() == self.map.points();
  const bool are_ids = points.ndim() == 1 && (kind == 'i' || kind == 'u' || points.size() == 0);
  if (!is_mask && !are_ids) throw py::type_error("points need ids as integers, or a mask with an item for each point");
  Numbers ids;
  if (is_mask) {
    const py::array_t<bool> mask(points);
    for (py::ssize_t i = 0; i < mask.size(); ++i) {
      if (mask.at(i)) ids.push_back(static_cast<int>(i));
    }
    return ids;
  }
  const py::array_t<std::int64_t, py::array::forcecast> numbers(points);
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const auto id = static_cast<int>(std::clamp<std::int64_t>(numbers.at(i), -1, self.map.points()));
    ids.push_back(checked(id, self.map.points(), "point"));
  }
  return ids;
}

template <typename Vector>
std::vector<Vector> rows_of(const py::array_t<double, py::array::forcecast>& rows, const char* name) {
  constexpr auto kColumns = static_cast<py::ssize_t>(Vector::RowsAtCompileTime);
  if (rows.ndim() != 2 || rows.shape(1) != kColumns)
    throw py::value_error(std::string(name) + " needs n x " + std::to_string(kColumns) + " numbers");
  std::vector<Vector> vectors(static_cast<std::size_t>(rows.shape(0)));
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    for (py::ssize_t k = 0; k < kColumns; ++k) {
      vectors[static_cast<std::size_t>(i)][k] = rows.at(i, k);
      if (!std::isfinite(rows.at(i, k))) throw py::value_error(std::string(name) + " has a number that is not finite");
    }
  }
  return vectors;
}

void bind_keyframe(py::module_& module) {
  const auto count_of = [](const MapKeyframe& keyframe) { return static_cast<py::ssize_t>(keyframe.features->size()); };
  py::class_<MapKeyframe>(module, "MapKeyframe",
                          "Keyframe of a Map. Features are the n corners that measure a point. Arrays are views of the "
                          "map's memory and are not writeable.")
      .def_readonly("id", &MapKeyframe::id, "Index into Map.keyframes.")
      .def_property_readonly(
          "time_ns", [](const MapKeyframe& keyframe) { return keyframe.time.count(); }, "Time stamp, nanoseconds.")
      .def_readonly("recording", &MapKeyframe::recording, "Index into Map.recordings.")
      .def_readonly("parent", &MapKeyframe::parent, "Id of the keyframe from which it was tracked, or None.")
      .def_property_readonly(
          "map_from_body", [](const MapKeyframe& keyframe) { return matrix_of(keyframe.map_from_body); },
          "Pose of the body, 4x4.")
      .def_property_readonly(
          "map_from_camera", [](const MapKeyframe& keyframe) { return matrix_of(keyframe.map_from_camera); },
          "Pose of the rectified left camera, 4x4.")
      .def_readonly("covariance", &MapKeyframe::covariance,
                    "Covariance of map_from_body, 6x6 as FrameReport.covariance.")
      .def_property_readonly(
          "camera",
          [](const MapKeyframe& keyframe) {
            const Rig& rig = keyframe.rig;
            return Camera{CameraModel::pinhole, rig.width, rig.height, rig.focal, rig.focal, rig.cx, rig.cy, {}};
          },
          "Rectified pinhole camera of all pixels.")
      .def_property_readonly(
          "baseline", [](const MapKeyframe& keyframe) { return keyframe.rig.baseline; },
          "Baseline of the rectified pair in lengths of the map; 0 for one camera.")
      .def_property_readonly(
          "pixels",
          [](const py::object& self) {
            const auto& pixels = self.cast<const MapKeyframe&>().pixels;
            const auto data = reinterpret_cast<const float*>(pixels.data());
            return array_in<float>({static_cast<py::ssize_t>(pixels.size()), 2},
                                   {sizeof(Eigen::Vector2f), sizeof(float)}, data, self);
          },
          "Measurements of the points, refined against their patches: n x 2, float32, pixels of camera.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            const auto& points = self.cast<const MapKeyframe&>().points;
            return array_in<int>({static_cast<py::ssize_t>(points.size())}, {sizeof(int)}, points.data(), self);
          },
          "Id of the point of each feature: n, int32; -1 without a point.")
      .def_property_readonly(
          "keypoints",
          [count_of](const py::object& self) {
            const auto& keyframe = self.cast<const MapKeyframe&>();
            const auto data = reinterpret_cast<const float*>(keyframe.features->keypoints().data());
            static_assert(offsetof(Keypoint, pixel) == 0);
            return array_in<float>({count_of(keyframe), 2}, {sizeof(Keypoint), sizeof(float)}, data, self);
          },
          "Corners as detected: n x 2, float32, pixels of camera.")
      .def_property_readonly(
          "disparities",
          [count_of](const py::object& self) {
            const auto& keyframe = self.cast<const MapKeyframe&>();
            const auto data = reinterpret_cast<const std::byte*>(keyframe.features->keypoints().data());
            return array_in<float>({count_of(keyframe)}, {sizeof(Keypoint)},
                                   reinterpret_cast<const float*>(data + offsetof(Keypoint, disparity)), self);
          },
          "Left minus right column: n, float32, pixels; negative without a match in the right image.")
      .def_property_readonly(
          "descriptors",
          [](const py::object& self) {
            const auto descriptors = self.cast<const MapKeyframe&>().features->descriptors();
            return array_in<std::uint8_t>({static_cast<py::ssize_t>(descriptors.size()), sizeof(Descriptor)},
                                          {sizeof(Descriptor), 1},
                                          reinterpret_cast<const std::uint8_t*>(descriptors.data()), self);
          },
          "Rotated BRIEF descriptors, packed as by cv2.ORB: n x 32, uint8.")
      .def("__repr__", [](const MapKeyframe& keyframe) {
        return "<MapKeyframe " + std::to_string(keyframe.id) + ", " + std::to_string(keyframe.points.size()) +
               " features>";
      });
  py::class_<MapObservation>(module, "MapObservation", "Measurement of a point by a keyframe.")
      .def_readonly("keyframe", &MapObservation::keyframe, "Id of the keyframe.")
      .def_readonly("feature", &MapObservation::feature, "Row of the keyframe's arrays.")
      .def_readonly("pixel", &MapObservation::pixel, "Column and row, pixels of MapKeyframe.camera.")
      .def_readonly("sigma", &MapObservation::sigma, "Standard deviation of column and of row, pixels.")
      .def("__repr__", [](const MapObservation& seen) {
        return "<MapObservation by keyframe " + std::to_string(seen.keyframe) + ">";
      });
  py::class_<MapRecording>(module, "MapRecording", "Recording that a map was made from.")
      .def_property_readonly(
          "name", [](const MapRecording& recording) { return text_of(recording.name); }, "Name given when mapping.")
      .def_readonly("calibration", &MapRecording::calibration, "Calibration with all refinements.")
      .def_property_readonly(
          "first_time_ns", [](const MapRecording& recording) { return recording.first_time.count(); },
          "Time of the first frame, nanoseconds.")
      .def_property_readonly(
          "last_time_ns", [](const MapRecording& recording) { return recording.last_time.count(); },
          "Time of the last frame, nanoseconds.");
}

void bind_plan(py::module_& module) {
  py::class_<PlanRegistration>(module, "PlanRegistration",
                               "Registration of a map on a floor plan: point_in_plan = plan_from_map @ (scale * "
                               "point_in_map). Plan frame: x and y as on the plan, z up from the driven floor; metres.")
      .def_property_readonly(
          "plan", [](const PlanRegistration& registration) { return text_of(registration.plan); }, "Name of the plan.")
      .def_property_readonly(
          "scale", [](const PlanRegistration& registration) { return registration.plan_from_map.scale; },
          "Metres per length of the map; 1 for a metric map.")
      .def_property_readonly(
          "plan_from_map",
          [](const PlanRegistration& registration) { return matrix_of(registration.plan_from_map.target_from_source); },
          "4x4, metres.")
      .def_readonly(
          "covariance", &PlanRegistration::covariance,
          "7x7: small motion in the map frame, translation before rotation, metres and radians, and logarithm "
          "of the scale.")
      .def(
          "plan_from_body",
          [](const PlanRegistration& registration, const Eigen::Matrix4d& map_from_body) {
            return matrix_of(plan_from_body(registration, pose_of(map_from_body, "map_from_body")));
          },
          py::arg("map_from_body"),
          "Pose on the plan of a pose in the map, 4x4, metres. Raises InputError if map_from_body is not a rigid "
          "motion.\n"
          ">>> registration = m.register_on_plan(\"barn.pgm\", picks_in_map, picks_in_plan).registration\n"
          ">>> registration.plan_from_body(np.eye(4)).shape\n"
          "(4, 4)");
  py::class_<PlanFit>(module, "PlanFit", "Fit of a map to points picked on a floor plan.")
      .def_readonly("registration", &PlanFit::registration, "The registration; Map.with_plan stores it.")
      .def_property_readonly(
          "errors",
          [](const PlanFit& fit) {
            std::vector<Eigen::Vector2d> errors;
            for (const PlanResidual& residual : fit.residuals) errors.push_back(residual.error_in_plan);
            return array_of<double>(std::move(errors), {2});
          },
          "Position by the map less that picked: n x 2, metres on the plan.")
      .def_property_readonly(
          "outliers",
          [](const PlanFit& fit) {
            Numbers outliers;
            for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
              if (fit.residuals[i].is_outlier) outliers.push_back(static_cast<int>(i));
            }
            return ids_of(std::move(outliers));
          },
          "Indices of the picks that were excluded as wrong, int32.")
      .def_readonly("rms", &PlanFit::rms, "Root mean square of the errors without outliers, metres.")
      .def_property_readonly(
          "doubts",
          [](const PlanFit& fit) {
            py::list doubts;
            for (const PlanDoubt doubt : fit.doubts) doubts.append(text_of(to_string(doubt)));
            return doubts;
          },
          "Reasons to doubt the registration, with remedies, as text.");
}

void bind_localisation(py::module_& module) {
  py::class_<LocalisationReport>(module, "LocalisationReport", "Result of localising an image in a Map.")
      .def_property_readonly(
          "map_from_body", [](const LocalisationReport& report) { return matrix_of(report.map_from_body); },
          "Pose in the map, 4x4; None if the image was not localised.")
      .def_property_readonly(
          "covariance",
          [](const LocalisationReport& report) {
            return report.map_from_body ? std::optional(report.covariance) : std::nullopt;
          },
          "Covariance of map_from_body, 6x6 as FrameReport.covariance; None without a pose.")
      .def_readonly("inliers", &LocalisationReport::inliers, "Points that fit the pose, or of the last step reached.")
      .def_readonly("failure", &LocalisationReport::failure, "Reason if there is no pose.")
      .def("__repr__", [](const LocalisationReport& report) {
        return "<LocalisationReport " +
               (report.map_from_body ? std::to_string(report.inliers) + " inliers"
                                     : std::string(to_string(report.failure))) +
               ">";
      });
}

LocalisationReport localise(CachedMap& self, const CameraImages& images,
                            const std::optional<Calibration>& calibration) {
  const py::gil_scoped_release release;
  const std::scoped_lock lock(self.mutex);
  if (!self.localiser || self.localised_by != calibration) {
    self.localiser.emplace(self.map, calibration);
    self.localised_by = calibration;
  }
  return self.localiser->localise(images);
}

// Runs without the GIL.
template <typename Make>
MapPointer made(Make make) {
  const py::gil_scoped_release release;
  return std::make_shared<CachedMap>(make());
}

using MapClass = py::class_<CachedMap, MapPointer>;

void bind_files(MapClass& type) {
  type.def_static(
          "load", [](const std::filesystem::path& path) { return made([&] { return Map::load(path); }); },
          py::arg("path"),
          "Reads a map file. Raises InputError naming section and byte for a missing or damaged file.\n\n"
          ">>> byre.Map.load(path)\n"
          "<Map ... keyframes, ... points, 1 recording, metric>")
      .def(
          "save",
          [](const CachedMap& self, const std::filesystem::path& path) {
            const py::gil_scoped_release release;
            self.map.save(path);
          },
          py::arg("path"),
          "Writes a map file, atomically. Raises InputError if it cannot be written, or exists and is no map.\n\n"
          ">>> m.save('copy.byre')\n"
          ">>> len(byre.Map.load('copy.byre').positions) == len(m.positions)\n"
          "True")
      .def_static(
          "import_colmap",
          [](const std::filesystem::path& model, const std::filesystem::path& images,
             const std::optional<double>& metres_per_unit, bool adds_points) {
            return made([&] { return import_colmap(model, images, metres_per_unit, adds_points); });
          },
          py::arg("model"), py::arg("images"), py::arg("metres_per_unit") = py::none(), py::arg("adds_points") = true,
          "Reads a COLMAP model with its images. Each image becomes a keyframe with its pose in the model, in the "
          "order "
          "of their times. Points of the model are kept, at their positions, if corners of two images match them.\n"
          "metres_per_unit: length of the model's unit; None: the map is not metric.\n"
          "adds_points: whether other corners become points, too.\n"
          "Raises InputError for a damaged or unsupported model, and for an image that is missing, damaged or of "
          "another "
          "size than its camera.\n\n"
          ">>> m.export_colmap('model', images_of=room)\n"
          ">>> again = byre.Map.import_colmap('model', room / 'mav0/cam0/data', metres_per_unit=1.0)\n"
          ">>> len(again.keyframes) == len(m.keyframes)\n"
          "True")
      .def(
          "export_colmap",
          [](const CachedMap& self, const std::filesystem::path& model,
             const std::optional<std::filesystem::path>& images_of) {
            const py::gil_scoped_release release;
            export_colmap(self.map, model, images_of);
          },
          py::arg("model"), py::arg("images_of") = py::none(),
          "Writes the map as a COLMAP model of its unrectified left images: poses, and points with two observations or "
          "more. Keyframe n and point n get the ids n + 1.\n"
          "model: folder, created if missing. images_of: recording whose file names the images get; None: "
          "<nanoseconds>.png.\n"
          "Raises InputError if a file cannot be written.\n\n"
          ">>> m.export_colmap('model')")
      .def(py::pickle(
          [](const CachedMap& self) {
            const std::vector<std::byte> bytes = self.map.to_bytes();
            return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
          },
          [](const py::bytes& state) {
            const std::string_view bytes(state);
            return std::make_shared<CachedMap>(
                Map::from_bytes(std::as_bytes(std::span(bytes.data(), bytes.size())), "pickled map"));
          }));
}

void bind_contents(MapClass& type) {
  type.def_property_readonly(
          "is_metric", [](const CachedMap& self) { return self.map.is_metric(); },
          "Whether lengths are metres; else they have an arbitrary unit.\n\n"
          ">>> m.is_metric\n"
          "True")
      .def_property_readonly(
          "recordings", [](const CachedMap& self) { return self.map.recordings(); },
          "Recordings that the map was made from, list of MapRecording.\n\n"
          ">>> m.recordings[0].name\n"
          "'live'")
      .def_property_readonly(
          "notes",
          [](const CachedMap& self) {
            py::dict notes;
            for (const auto& [key, text] : self.map.notes()) notes[text_of(key)] = text_of(text);
            return notes;
          },
          "Text by key, such as 'site' and 'software', dict.\n\n"
          ">>> 'byre' in m.notes['software']\n"
          "True")
      .def_property_readonly(
          "history",
          [](const CachedMap& self) {
            std::vector<std::pair<std::string, std::string>> history;
            for (const MapHistory& entry : self.map.history()) {
              history.emplace_back(fmt::format("{:016x}", entry.parent), entry.change);
            }
            return history;
          },
          "Updates that the map was made by, the newest first: list of the updated map's id and the change, str.\n\n"
          ">>> m.history\n"
          "[]")
      .def(
          "difference",
          [](const CachedMap& self, const CachedMap& after) {
            const MapDifference difference = self.map.difference(after.map);
            py::dict ids;
            ids["removed_keyframes"] = ids_of(difference.removed_keyframes);
            ids["removed_points"] = ids_of(difference.removed_points);
            ids["added_keyframes"] = ids_of(difference.added_keyframes);
            ids["added_points"] = ids_of(difference.added_points);
            return ids;
          },
          py::arg("after"),
          "What one map has and another one does not, at exactly the same position: dict of ids, int32, ascending. "
          "removed_keyframes and removed_points are of this map, added_keyframes and added_points of the other.\n\n"
          ">>> m.difference(m.without_points([0]))['removed_points']\n"
          "array([0], dtype=int32)")
      .def_property_readonly(
          "plan", [](const CachedMap& self) { return self.map.plan(); },
          "Registration on a floor plan, PlanRegistration, or None.\n\n"
          ">>> m.plan is None\n"
          "True")
      .def_property_readonly(
          "tags", [](const CachedMap& self) { return self.map.tags(); },
          "AprilTags, list of MappedTag.\n\n"
          ">>> m.tags\n"
          "[]")
      .def_property_readonly(
          "keyframes",
          [](CachedMap& self) {
            return cached(self.keyframes, [&] {
              py::tuple keyframes(self.map.keyframes());
              for (int i = 0; i < self.map.keyframes(); ++i)
                keyframes[static_cast<std::size_t>(i)] = self.map.keyframe(i);
              return keyframes;
            });
          },
          "Keyframes by id, tuple of MapKeyframe.\n\n"
          ">>> keyframe = m.keyframes[-1]\n"
          ">>> keyframe.map_from_body.shape, keyframe.descriptors.shape[1]\n"
          "((4, 4), 32)\n"
          ">>> in_camera = np.linalg.inv(keyframe.map_from_camera)[:3] @ np.append(m.positions[keyframe.points[0]], "
          "1)\n"
          ">>> camera = keyframe.camera\n"
          ">>> pixel = camera.fx * in_camera[:2] / in_camera[2] + [camera.cx, camera.cy]\n"
          ">>> bool(np.linalg.norm(pixel - keyframe.pixels[0]) < 5)\n"
          "True")
      .def_property_readonly(
          "positions",
          [](CachedMap& self) {
            return cached(self.positions, [&] { return array_of<double>(self.map.positions(), {3}); });
          },
          "Positions of the points by id: n x 3, float64.\n\n"
          ">>> m.positions.shape == (len(m.grey_values), 3)\n"
          "True")
      .def_property_readonly(
          "covariances",
          [](CachedMap& self) {
            return cached(self.covariances, [&] { return array_of<double>(self.map.covariances(), {3, 3}); });
          },
          "Covariances of the positions: n x 3 x 3, float64, squared lengths.\n\n"
          ">>> sigmas = np.sqrt(np.trace(m.covariances, axis1=1, axis2=2))\n"
          ">>> bool(np.median(sigmas) < 0.2)\n"
          "True")
      .def_property_readonly(
          "grey_values",
          [](CachedMap& self) {
            return cached(self.grey_values, [&] {
              std::vector<std::int16_t> values;
              const int count = self.map.points();
              for (int i = 0; i < count; ++i) {
                const auto grey = self.map.grey(i);
                values.push_back(grey ? static_cast<std::int16_t>(*grey) : std::int16_t{-1});
              }
              return array_of<std::int16_t>(std::move(values), {});
            });
          },
          "Grey value of the image at each point, 0 to 255: n, int16; -1 if unknown.\n\n"
          ">>> bool((m.grey_values >= 0).all())\n"
          "True")
      .def_property_readonly(
          "observation_counts",
          [](CachedMap& self) {
            return cached(self.observation_counts, [&] { return ids_of(self.map.observation_counts()); });
          },
          "Number of keyframes that observe each point: n, int32.\n\n"
          ">>> int(m.observation_counts[7]) == len(m.observations(7))\n"
          "True")
      .def_property_readonly(
          "recording_counts",
          [](CachedMap& self) {
            return cached(self.recording_counts, [&] { return ids_of(self.map.recording_counts()); });
          },
          "Number of recordings that observe each point: n, int32. Points of several visits are of lasting "
          "structure.\n\n"
          ">>> bool((m.recording_counts == 1).all())  # this map has one recording\n"
          "True")
      .def(
          "picture",
          [](const CachedMap& self, int keyframe) -> py::object {
            std::optional<Image> picture = self.map.picture(checked(keyframe, self.map.keyframes(), "keyframe"));
            if (!picture) return py::none();
            const py::ssize_t width = picture->width;
            const py::array rows = array_of<std::uint8_t>(std::move(picture->pixels), {});
            return rows.attr("reshape")(-1, width);
          },
          py::arg("keyframe"),
          "Small grey picture of a keyframe's left image, as rectified: rows x columns, uint8. None without one.\n\n"
          ">>> picture = m.picture(0)  # shown by matplotlib.pyplot.imshow(picture, cmap=\"gray\")\n"
          ">>> picture.dtype.name, picture.shape[1] <= m.keyframes[0].camera.width\n"
          "('uint8', True)")
      .def(
          "observations",
          [](const CachedMap& self, int point) {
            return self.map.observations(checked(point, self.map.points(), "point"));
          },
          py::arg("point"),
          "Observations of a point, list of MapObservation, ascending by keyframe. Raises IndexError.\n\n"
          ">>> seen = m.observations(0)[0]\n"
          ">>> bool((m.keyframes[seen.keyframe].pixels[seen.feature] == seen.pixel).all())\n"
          "True")
      .def(
          "trajectory",
          [](const CachedMap& self, int recording) {
            return self.map.trajectory(checked(recording, static_cast<int>(self.map.recordings().size()), "recording"));
          },
          py::arg("recording") = 0,
          "map_from_body of the keyframes of a recording, Trajectory. Raises IndexError.\n\n"
          ">>> len(m.trajectory()) == len(m.keyframes)\n"
          "True")
      .def("__repr__", [](const CachedMap& self) { return text_of("<Map " + self.map.summary() + ">"); });
}

void bind_queries(MapClass& type) {
  type.def(
          "points_in_view",
          [](const CachedMap& self, const Eigen::Matrix4d& map_from_body, double max_distance, int recording) {
            checked(recording, static_cast<int>(self.map.recordings().size()), "recording");
            return ids_of(self.map.points_in_view(pose_of(map_from_body, "map_from_body"), max_distance, recording));
          },
          py::arg("map_from_body"), py::arg("max_distance"), py::arg("recording") = 0,
          "Ids of the points inside the image of a recording's rectified camera and at most max_distance from it, "
          "int32, "
          "ascending. Hidden points are included. Raises InputError if map_from_body is not a rigid motion, and "
          "IndexError.\n\n"
          ">>> seen = m.keyframes[0].points\n"
          ">>> bool(np.isin(seen, m.points_in_view(m.keyframes[0].map_from_body, 100.0)).mean() > 0.9)\n"
          "True")
      .def(
          "nearest_points",
          [](const CachedMap& self, const Eigen::Vector3d& place_in_map, int count) {
            return ids_of(self.map.nearest_points(place_in_map, count));
          },
          py::arg("place_in_map"), py::arg("count"),
          "Ids of the nearest points, int32, nearest first; fewer than count if the map has fewer.\n\n"
          ">>> int(m.nearest_points(m.positions[7], 3)[0])\n"
          "7")
      .def(
          "points_in_box",
          [](const CachedMap& self, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
            return ids_of(self.map.points_in_box(low, high));
          },
          py::arg("low"), py::arg("high"),
          "Ids of the points in a box along the axes of the map, int32, ascending.\n\n"
          ">>> inside = m.points_in_box([-1, -1, 0], [1, 1, 4])\n"
          ">>> bool((np.abs(m.positions[inside][:, :2]) <= 1).all())\n"
          "True")
      .def(
          "points_in_sphere",
          [](const CachedMap& self, const Eigen::Vector3d& centre_in_map, double radius) {
            return ids_of(self.map.points_in_sphere(centre_in_map, radius));
          },
          py::arg("centre_in_map"), py::arg("radius"),
          "Ids of the points in a sphere, int32, ascending.\n\n"
          ">>> 7 in m.points_in_sphere(m.positions[7], 0.1)\n"
          "True")
      .def(
          "points_in_polygon",
          [](const CachedMap& self, const py::array_t<double, py::array::forcecast>& corners_in_plan) {
            const auto corners = rows_of<Eigen::Vector2d>(corners_in_plan, "corners_in_plan");
            return ids_of(self.map.points_in_polygon(corners));
          },
          py::arg("corners_in_plan"),
          "Ids of the points whose position on the floor plan is inside a polygon, at any height, int32, ascending. "
          "corners_in_plan: n x 2, metres on the plan. Raises InputError if the map is not registered on a plan.\n\n"
          ">>> on_plan = m.with_plan(m.register_on_plan('plan.png', picks_in_map, picks_in_plan))\n"
          ">>> len(on_plan.points_in_polygon([[-99, -99], [99, -99], [99, 99], [-99, 99]])) == len(m.positions)\n"
          "True")
      .def(
          "keyframes_near",
          [](const CachedMap& self, const Eigen::Vector3d& place_in_map, double radius) {
            return ids_of(self.map.keyframes_near(place_in_map, radius));
          },
          py::arg("place_in_map"), py::arg("radius"),
          "Ids of the keyframes whose camera is at most radius from a place, int32, nearest first.\n\n"
          ">>> int(m.keyframes_near(m.keyframes[2].map_from_camera[:3, 3], 1.0)[0])\n"
          "2");
}

void bind_edits(MapClass& type) {
  type.def(
          "without_points",
          [](const CachedMap& self, const py::object& points) {
            const Numbers ids = selected(self, points);
            return made([&] { return self.map.without_points(ids); });
          },
          py::arg("points"),
          "Copy without these points and their observations; the other points are renumbered. Keyframes that "
          "observe "
          "no other point are removed too, except those without a parent.\n"
          "points: ids, or a mask with an item for each point. Raises IndexError for ids that do not exist, and "
          "TypeError "
          "for other arrays.\n\n"
          ">>> edited = m.without_points(m.points_in_sphere(m.positions[7], 0.5))\n"
          ">>> len(edited.positions) < len(m.positions)\n"
          "True\n"
          ">>> often_seen = m.without_points(m.observation_counts < 3)\n"
          ">>> int(often_seen.observation_counts.min())\n"
          "3")
      .def(
          "transformed",
          [](const CachedMap& self, const Eigen::Matrix4d& target_from_map, double scale) {
            const Similarity similarity{scale, pose_of(target_from_map, "target_from_map")};
            return made([&] { return self.map.transformed(similarity); });
          },
          py::arg("target_from_map"), py::arg("scale") = 1.0,
          "Copy in another frame: point_in_target = target_from_map @ (scale * point_in_map). Covariances, baselines "
          "and "
          "the registration on a plan are adapted. Raises InputError if target_from_map is not a rigid motion, or the "
          "scale is not positive.\n\n"
          ">>> up = np.eye(4)\n"
          ">>> up[2, 3] = 1.5\n"
          ">>> np.allclose(m.transformed(up).positions, m.positions + [0, 0, 1.5])\n"
          "True")
      .def(
          "merged_with",
          [](const CachedMap& self, const CachedMap& other) {
            return made([&] { return self.map.merged_with(other.map); });
          },
          py::arg("other"),
          "Merged with a map that overlaps, in the frame and on the plan of this one. Keyframes keep their numbers, "
          "those of the other follow. Raises InputError with the reason if the maps do not overlap, or a similar "
          "building is likelier.\n\n"
          ">>> both = m.merged_with(m.transformed(np.eye(4)))\n"
          ">>> len(both.keyframes) > len(m.keyframes)\n"
          "True")
      .def(
          "register_on_plan",
          [](const CachedMap& self, const std::string& plan,
             const py::array_t<double, py::array::forcecast>& points_in_map,
             const py::array_t<double, py::array::forcecast>& points_in_plan, double sigma, double body_height) {
            const auto in_map = rows_of<Eigen::Vector3d>(points_in_map, "points_in_map");
            const auto in_plan = rows_of<Eigen::Vector2d>(points_in_plan, "points_in_plan");
            if (in_map.size() != in_plan.size())
              throw py::value_error("points_in_map and points_in_plan need equal numbers of rows");
            if (!(sigma > 0.0)) throw py::value_error("sigma must be positive");
            std::vector<PlanCorrespondence> picks;
            for (std::size_t i = 0; i < in_map.size(); ++i) picks.push_back({"", in_map[i], in_plan[i], sigma});
            PlanRegistrationOptions options;
            options.body_height = body_height;
            return self.map.register_on_plan(plan, picks, options);
          },
          py::arg("plan"), py::arg("points_in_map"), py::arg("points_in_plan"), py::arg("sigma") = 0.05,
          py::arg("body_height") = 0.0,
          "Fits the map to points picked on a floor plan, with the scale if the map is not metric. Returns a PlanFit.\n"
          "plan: name of the plan's file. points_in_map: n x 3. points_in_plan: n x 2, metres on the plan.\n"
          "sigma: standard deviation of the picks, metres. body_height: height of the body above the floor, metres.\n"
          "Raises InputError if the picks do not determine the registration, and ValueError for other shapes.\n\n"
          ">>> fit = m.register_on_plan('plan.png', picks_in_map, picks_in_plan)\n"
          ">>> fit.rms < 0.2, len(fit.outliers)\n"
          "(True, 0)")
      .def(
          "with_plan",
          [](const CachedMap& self, const PlanFit& fit, double accepted_residual) {
            return made([&] { return self.map.with_plan(fit, accepted_residual); });
          },
          py::arg("fit"), py::arg("accepted_residual") = kLargePlanResidual,
          "Copy with the registration of a PlanFit. Raises InputError if its residuals exceed accepted_residual, "
          "metres.\n\n"
          ">>> m.with_plan(m.register_on_plan('plan.png', picks_in_map, picks_in_plan)).plan.plan\n"
          "'plan.png'")
      .def(
          "with_tags",
          [](const CachedMap& self, const std::vector<Tag>& surveyed) {
            return made([&] { return self.map.with_tags(surveyed); });
          },
          py::arg("surveyed"),
          "Copy with the tags added, of read_tags, that are surveyed with a heading and that the map does not have. "
          "Their heights are right if register_on_plan got the body's height. Raises InputError if the map is not "
          "registered on a plan.\n\n"
          ">>> registered = m.with_plan(m.register_on_plan('plan.png', picks_in_map, picks_in_plan))\n"
          ">>> registered.with_tags([]).tags == m.tags\n"
          "True");
}

void bind_localising(MapClass& type) {
  type.def(
          "localise",
          [](CachedMap& self, const ImageFrame& images, const std::optional<Calibration>& calibration) {
            return localise(self, view_of(images), calibration);
          },
          py::arg("images"), py::arg("calibration") = py::none(),
          "Localises images without a prediction; returns a LocalisationReport. The first call takes some tenths of a "
          "second, as does a call with another calibration.\n"
          "images: of a Recording. calibration: cameras of the images; None: those of the map's newest recording.\n"
          "Raises InputError if an image differs from the calibration in size or kind.\n\n"
          ">>> m.localise(images).failure.name\n"
          "'none'")
      .def(
          "localise",
          [](CachedMap& self, const py::array& left, const std::optional<py::array>& right,
             const std::optional<py::array>& depth, const std::optional<Calibration>& calibration,
             const std::optional<PixelFormat>& format,
             int bits) { return localise(self, images_of(left, right, depth, format, bits), calibration); },
          py::arg("left"), py::arg("right") = py::none(), py::arg("depth") = py::none(),
          py::arg("calibration") = py::none(), py::arg("format") = py::none(), py::arg("bits") = 16,
          "The same for arrays, as for Slam.process.\n\n"
          ">>> report = m.localise(images.left)\n"
          ">>> report.map_from_body.shape, report.covariance.shape, report.inliers >= 40\n"
          "((4, 4), (6, 6), True)");
}

}  // namespace

void bind_map(py::module_& module) {
  bind_keyframe(module);
  bind_plan(module);
  bind_localisation(module);
  MapClass type(module, "Map",
                "A saved map: keyframes, points and their observations. Maps do not change, and edits return another "
                "map. Keyframes and points are numbered from 0; points are rows of arrays, which are not writeable. "
                "Lengths are metres if is_metric. Maps can be pickled.");
  bind_files(type);
  bind_contents(type);
  bind_queries(type);
  bind_edits(type);
  bind_localising(type);
}

}  // namespace byre::python
