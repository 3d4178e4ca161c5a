#pragma once

#include "bindings.h"

#include "byre/calibration.h"
#include "byre/frame_report.h"
#include "byre/localisation_failure.h"
#include "byre/recording.h"
#include "byre/slam.h"
#include "byre/trajectory_file.h"

#include <type_traits>

namespace byre::python {

// Enumerations use Python's enum module, one type each.
template <typename Enum>
struct PythonEnum {
  inline static py::handle type;  // Python type; created by bind_enums, never released
};

// Precondition: bind_enums was called.
template <typename Enum>
py::object to_python(Enum value) {
  return py::reinterpret_borrow<py::object>(PythonEnum<Enum>::type)(static_cast<int>(value));
}

void bind_enums(py::module_& module);

}  // namespace byre::python

namespace pybind11::detail {

template <typename Enum>
requires std::is_enum_v<Enum>
struct type_caster<Enum> {
  PYBIND11_TYPE_CASTER(Enum, const_name("enum"));

  bool load(handle source, bool /*convert*/) {
    const handle type = byre::python::PythonEnum<Enum>::type;
    if (!type || !isinstance(source, type)) return false;
    value = static_cast<Enum>(source.attr("value").cast<int>());
    return true;
  }
  static handle cast(Enum source, return_value_policy /*policy*/, handle /*parent*/) {
    return byre::python::to_python(source).release();
  }
};

}  // namespace pybind11::detail
