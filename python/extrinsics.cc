// Extrinsics of a robot and their files.

#include "bindings.h"

#include "byre/extrinsics.h"
#include "byre/extrinsics_file.h"

#include <string>

namespace byre::python {
namespace {

// A number as Python prints it.
std::string repr_of(double number) {
  return py::repr(py::float_(number)).cast<std::string>();
}

std::string repr_of(const SensorMounting& mounting) {
  const Eigen::Vector3d& position = mounting.base_from_sensor.translation;
  return "<SensorMounting at (" + repr_of(position.x()) + ", " + repr_of(position.y()) + ", " + repr_of(position.z()) +
         ") m, sigma " + repr_of(mounting.sigma_m) + " m, " + repr_of(mounting.sigma_rad) + " rad>";
}

std::string repr_of(const std::optional<SensorMounting>& mounting) {
  return mounting ? repr_of(*mounting) : "None";
}

std::string repr_of(const Extrinsics& extrinsics) {
  return "<Extrinsics camera " + repr_of(extrinsics.camera) + ", imu " + repr_of(extrinsics.imu) + ", wheel_scale " +
         repr_of(extrinsics.wheel_scale) + ", sigma " + repr_of(extrinsics.wheel_scale_sigma) + ", wheel_delay " +
         (extrinsics.wheel_delay ? repr_of(*extrinsics.wheel_delay) + " s" : "None") + ">";
}

void bind_mounting(py::module_& module) {
  py::class_<SensorMounting>(module, "SensorMounting",
                             "Pose of a sensor on the robot's base. The base has x ahead, y to the left and z up, and "
                             "drives in its x-y plane; "
                             "its origin is the point whose motion the wheel odometry measures. Cannot be changed.")
      .def(py::init([](const Eigen::Matrix4d& base_from_sensor, double sigma_m, double sigma_rad) {
             return SensorMounting{pose_of(base_from_sensor, "base_from_sensor"), sigma_m, sigma_rad};
           }),
           py::arg("base_from_sensor"), py::arg("sigma_m") = SensorMounting{}.sigma_m,
           py::arg("sigma_rad") = SensorMounting{}.sigma_rad,
           "base_from_sensor: 4x4, metres. Raises InputError if it is not a rigid motion.")
      .def_property_readonly(
          "base_from_sensor", [](const SensorMounting& mounting) { return matrix_of(mounting.base_from_sensor); },
          "4x4 pose, metres.")
      .def_readonly("sigma_m", &SensorMounting::sigma_m,
                    "Standard deviation of the translation, each axis, metres; the default is that of a tape measure.")
      .def_readonly("sigma_rad", &SensorMounting::sigma_rad,
                    "Standard deviation of the rotation, about each axis, radians; the default is 2 degrees.")
      .def("__repr__", [](const SensorMounting& mounting) { return repr_of(mounting); });
}

void bind_values(py::module_& module) {
  const Extrinsics defaults;
  py::class_<Extrinsics>(module, "Extrinsics",
                         "Extrinsics of a robot as measured by hand, designed, or found on an earlier drive. Driving "
                         "refines them, and a mounting that motions contradict is reported and dropped. Cannot be "
                         "changed.")
      .def(py::init([](const std::optional<SensorMounting>& camera, const std::optional<SensorMounting>& imu,
                       double wheel_scale, double wheel_scale_sigma, const std::optional<double>& wheel_delay) {
             return Extrinsics{camera, imu, wheel_scale, wheel_scale_sigma, wheel_delay};
           }),
           py::arg("camera") = py::none(), py::kw_only(), py::arg("imu") = py::none(),
           py::arg("wheel_scale") = defaults.wheel_scale, py::arg("wheel_scale_sigma") = defaults.wheel_scale_sigma,
           py::arg("wheel_delay") = py::none(), "A Slam requires the camera.")
      .def_readonly("camera", &Extrinsics::camera,
                    "Left or only camera: x to the right of the image, y down, z ahead. None: estimated while driving.")
      .def_readonly("imu", &Extrinsics::imu, "Gyroscope and accelerometer. None: estimated while driving.")
      .def_readonly("wheel_scale", &Extrinsics::wheel_scale, "True metres per metre of the wheel odometry.")
      .def_readonly("wheel_scale_sigma", &Extrinsics::wheel_scale_sigma, "Relative standard deviation of wheel_scale.")
      .def_readonly("wheel_delay", &Extrinsics::wheel_delay,
                    "Delay of the wheels' stamps against the images', seconds. None: estimated while driving.")
      .def("__repr__", [](const Extrinsics& extrinsics) { return repr_of(extrinsics); });
}

void bind_files(py::module_& module) {
  const py::call_guard<py::gil_scoped_release> released;
  module.def(
      "read_extrinsics",
      [](const std::filesystem::path& path, const std::string& base, const std::string& camera,
         const std::string& imu) {
        return read_extrinsics(path, {base, camera, imu});
      },
      py::arg("path"), py::kw_only(), py::arg("base") = "", py::arg("camera") = "", py::arg("imu") = "", released,
      "Reads the extrinsics of a robot from YAML, a URDF or the /tf_static of a bag, see the reference page "
      "\"extrinsics\".\n"
      "base, camera, imu: frames in a URDF or bag; default: found by the conventions of that page.\n"
      "Raises InputError with the place for a missing, ambiguous or moving frame, an unknown field, and for a value "
      "that is no rotation, not finite or likely in the wrong unit or axes.\n"
      ">>> mounting = byre.SensorMounting(np.eye(4), sigma_m=0.01)\n"
      ">>> byre.write_extrinsics(\"robot.yaml\", byre.Extrinsics(mounting))\n"
      ">>> byre.read_extrinsics(\"robot.yaml\").camera.sigma_m\n"
      "0.01");
  module.def(
      "write_extrinsics", &write_extrinsics, py::arg("path"), py::arg("extrinsics"), released,
      "Writes the extrinsics as YAML, which read_extrinsics reads. Raises InputError for lengths and scales that "
      "it would reject, and if the file cannot be written.\n"
      ">>> mounting = byre.SensorMounting(np.eye(4), sigma_m=0.01)\n"
      ">>> byre.write_extrinsics(\"robot.yaml\", byre.Extrinsics(mounting))");
}

}  // namespace

void bind_extrinsics(py::module_& module) {
  bind_mounting(module);
  bind_values(module);
  bind_files(module);
}

}  // namespace byre::python
