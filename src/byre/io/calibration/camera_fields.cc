#include "byre/io/calibration/camera_fields.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

// Names of a projection and a distortion, and the model of both. shape: parameters before the focal lengths.
struct LensKind {
  std::string_view camera_model;
  std::string_view distortion_model;
  CameraModel model = CameraModel::pinhole;
  std::size_t shape = 0;
};

// The first entry of a model is written.
constexpr std::array kKinds = {
    LensKind{"pinhole", "none", CameraModel::pinhole},
    LensKind{"pinhole", "radtan", CameraModel::radial_tangential},
    LensKind{"pinhole", "radial-tangential", CameraModel::radial_tangential},
    LensKind{"pinhole", "radialtangential", CameraModel::radial_tangential},
    LensKind{"pinhole", "plumb_bob", CameraModel::radial_tangential},
    LensKind{"pinhole", "equidistant", CameraModel::equidistant},
    LensKind{"pinhole", "equi", CameraModel::equidistant},
    LensKind{"pinhole", "kannala_brandt", CameraModel::equidistant},
    LensKind{"pinhole", "rational", CameraModel::rational},
    LensKind{"pinhole", "rational_polynomial", CameraModel::rational},
    LensKind{"pinhole", "radialtangential8", CameraModel::rational},
    LensKind{"pinhole", "fov", CameraModel::field_of_view},
    LensKind{"pinhole", "field_of_view", CameraModel::field_of_view},
    LensKind{"pinhole", "thin_prism_fisheye", CameraModel::thin_prism_fisheye},
    LensKind{"omni", "radtan", CameraModel::unified, 1},
    LensKind{"omni", "radial-tangential", CameraModel::unified, 1},
    LensKind{"omni", "none", CameraModel::unified, 1},
    LensKind{"unified", "radtan", CameraModel::unified, 1},
    LensKind{"unified", "none", CameraModel::unified, 1},
    LensKind{"eucm", "radtan", CameraModel::extended_unified, 2},
    LensKind{"eucm", "none", CameraModel::extended_unified, 2},
    LensKind{"ds", "radtan", CameraModel::double_sphere, 2},
    LensKind{"ds", "none", CameraModel::double_sphere, 2},
};

constexpr std::string_view kSupported =
    "supported models: pinhole with radial-tangential (radtan), rational, equidistant (fisheye), fov or no distortion "
    "(none); omni, eucm and ds with radtan or none; calibrate with one of these, in Kalibr with --models "
    "pinhole-radtan "
    "or pinhole-equi";

[[noreturn]] void refuse_model(const std::string& place, const std::string& model) {
  throw InputError(place, "\"" + model + "\" is not supported", std::string(kSupported));
}

CameraModel parse_lens_model(const CalibrationFields& fields) {
  const std::string distortion = fields.text("distortion_model");
  const auto found = std::ranges::find(kKinds, distortion, &LensKind::distortion_model);
  if (found == kKinds.end()) refuse_model(fields.place("distortion_model"), distortion);
  return found->model;
}

void read_resolution(const CalibrationFields& fields, Camera& camera) {
  const std::vector<double> resolution = fields.numbers("resolution", 2);
  camera.width = to_image_side(resolution[0], fields.place("resolution"));
  camera.height = to_image_side(resolution[1], fields.place("resolution"));
}

// Model names of OpenCV's programs and ROS; without a name, the lens of cv::calibrateCamera.
bool is_opencv_fisheye(const CalibrationFields& fields) {
  if (fields.has("distortion_model")) {
    const std::string distortion = fields.text("distortion_model");
    if (distortion == "plumb_bob" || distortion == "rational_polynomial" || distortion.empty()) return false;
    return distortion == "fisheye" || parse_lens_model(fields) == CameraModel::equidistant;
  }
  return fields.has("fisheye_model") && fields.text("fisheye_model") != "0";
}

std::string count_text(std::size_t count, std::size_t needed) {
  return fmt::format("has {} numbers instead of {}", count, needed);
}

// Number of coefficients of a distortion without shape parameters, at least and at most.
std::pair<std::size_t, std::size_t> coefficient_counts(CameraModel model) {
  switch (model) {
    case CameraModel::pinhole:
      return {0, 14};
    case CameraModel::radial_tangential:
      return {4, 5};
    case CameraModel::rational:
      return {4, 14};
    case CameraModel::field_of_view:
      return {1, 5};
    case CameraModel::thin_prism_fisheye:
      return {8, 8};
    case CameraModel::equidistant:
    case CameraModel::unified:
    case CameraModel::extended_unified:
    case CameraModel::double_sphere:
      break;
  }
  return {4, 4};
}

void require_shape(bool is_valid, const std::string& place, const std::string& domain) {
  if (!is_valid) throw InputError(place, "has shape parameters outside " + domain, "calibrate again");
}

void require_valid_shape(const Camera& camera, const std::string& place) {
  const auto& d = camera.distortion;
  switch (camera.model) {
    case CameraModel::unified:
      return require_shape(d[4] > -1.0, place, "xi > -1");
    case CameraModel::extended_unified:
      return require_shape(d[4] >= 0.0 && d[4] <= 1.0 && d[5] > 0.0, place, "0 <= alpha <= 1, beta > 0");
    case CameraModel::double_sphere:
      return require_shape(d[4] > -1.0 && d[4] <= 1.0 && d[5] >= 0.0 && d[5] <= 1.0, place,
                           "-1 < xi <= 1, 0 <= alpha <= 1");
    case CameraModel::field_of_view:
      return require_shape(d[4] > 1e-6 && d[4] < std::numbers::pi, place, "0 < omega < pi");
    case CameraModel::pinhole:
    case CameraModel::radial_tangential:
    case CameraModel::equidistant:
    case CameraModel::rational:
    case CameraModel::thin_prism_fisheye:
      break;
  }
}

bool is_zero(double value) {
  return value == 0.0;
}

}  // namespace

void require_valid(const Camera& camera, const std::string& place) {
  if (!(camera.fx > 0.0) || !(camera.fy > 0.0)) throw InputError(place, "the focal lengths must be positive");
  require_valid_shape(camera, place);
  if (camera.width == 0 || camera.contains({camera.cx, camera.cy})) return;
  throw InputError(place, "the principal point is outside the image",
                   "check that the intrinsics belong to this resolution");
}

void set_camera_matrix(Camera& camera, const std::vector<double>& matrix, const std::string& place) {
  const bool is_pinhole = matrix[1] == 0.0 && matrix[3] == 0.0 && matrix[6] == 0.0 && matrix[7] == 0.0;
  if (!is_pinhole || matrix[8] != 1.0) {
    throw InputError(place, "is not of the form fx 0 cx, 0 fy cy, 0 0 1", "calibrate without skew");
  }
  camera.fx = matrix[0];
  camera.cx = matrix[2];
  camera.fy = matrix[4];
  camera.cy = matrix[5];
  require_valid(camera, place);
}

void set_skewed_matrix(Camera& camera, std::vector<double> matrix, const std::string& place,
                       std::vector<std::string>& notes) {
  constexpr double kMostError = 0.25;  // pixels
  const double reach = std::max(matrix[5], camera.height - matrix[5]) / std::max(matrix[4], 1.0);
  if (const double error = std::abs(matrix[1]) * reach; matrix[1] != 0.0 && error < kMostError) {
    notes.push_back(fmt::format("{}: a skew of {:.3g} is left out, which moves pixels by at most {:.2g} pixels", place,
                                matrix[1], error));
    matrix[1] = 0.0;
  }
  set_camera_matrix(camera, matrix, place);
}

void set_opencv_distortion(Camera& camera, std::span<const double> coefficients, bool is_fisheye,
                           const std::string& place) {
  constexpr std::size_t kLeast = 4;
  const bool is_distorted = !std::ranges::all_of(coefficients, is_zero);
  const std::size_t given = coefficients.size();
  if (given < kLeast && (given > 0 || is_fisheye)) throw InputError(place, count_text(given, kLeast));
  while (coefficients.size() > kLeast && is_zero(coefficients.back()))
    coefficients = coefficients.first(coefficients.size() - 1);
  if (is_fisheye && coefficients.size() > kLeast) throw InputError(place, count_text(given, kLeast));
  if (coefficients.size() > camera.distortion.size()) {
    throw InputError(place, count_text(given, camera.distortion.size()) + " or less");
  }
  camera.distortion = {};
  std::ranges::copy(coefficients, camera.distortion.begin());
  camera.model = is_fisheye                ? CameraModel::equidistant
                 : !is_distorted           ? CameraModel::pinhole
                 : coefficients.size() > 5 ? CameraModel::rational
                                           : CameraModel::radial_tangential;
}

KalibrLens kalibr_lens(const Camera& camera) {
  const auto& d = camera.distortion;
  const auto kind = std::ranges::find(kKinds, camera.model, &LensKind::model);
  KalibrLens lens{std::string(kind->camera_model),
                  {d.begin() + 4, d.begin() + 4 + static_cast<std::ptrdiff_t>(kind->shape)},
                  std::string(kind->distortion_model),
                  {d.begin(), d.begin() + 4}};
  lens.intrinsics.insert(lens.intrinsics.end(), {camera.fx, camera.fy, camera.cx, camera.cy});
  if (camera.model == CameraModel::radial_tangential && d[4] != 0.0) lens.coefficients.push_back(d[4]);
  if (camera.model == CameraModel::rational) lens.coefficients.assign(d.begin(), d.end());
  if (camera.model == CameraModel::thin_prism_fisheye) lens.coefficients.assign(d.begin(), d.begin() + 8);
  if (camera.model == CameraModel::field_of_view) {
    const bool has_more = !std::all_of(d.begin(), d.begin() + 4, is_zero);
    lens.coefficients.assign(d.begin() + 4, d.begin() + 5);
    if (has_more) lens.coefficients.insert(lens.coefficients.end(), d.begin(), d.begin() + 4);
  }
  return lens;
}

void set_kalibr_lens(Camera& camera, const KalibrLens& lens, const std::string& place) {
  const auto kind = std::ranges::find_if(kKinds, [&](const LensKind& each) {
    return each.camera_model == lens.camera_model && each.distortion_model == lens.distortion_model;
  });
  if (kind == kKinds.end()) refuse_model(place, lens.camera_model + " with " + lens.distortion_model);
  const std::size_t needed = kind->shape + 4;
  if (lens.intrinsics.size() != needed) throw InputError(place, count_text(lens.intrinsics.size(), needed));
  camera.model = kind->model;
  camera.distortion = {};
  const double* const focal = lens.intrinsics.data() + kind->shape;
  camera.fx = focal[0], camera.fy = focal[1], camera.cx = focal[2], camera.cy = focal[3];
  std::copy_n(lens.intrinsics.begin(), kind->shape, camera.distortion.begin() + 4);
  if (kind->distortion_model == "none") return require_valid(camera, place);
  const auto [least, most] = coefficient_counts(kind->model);
  const std::size_t count = lens.coefficients.size();
  if (count < least || count > most) throw InputError(place, count_text(count, least));
  if (kind->model == CameraModel::field_of_view) {
    camera.distortion[4] = lens.coefficients.front();
    std::copy(lens.coefficients.begin() + 1, lens.coefficients.end(), camera.distortion.begin());
  } else {
    std::ranges::copy(lens.coefficients, camera.distortion.begin());
  }
  require_valid(camera, place);
}

Camera read_camera_fields(const CalibrationFields& fields, const std::string& coefficients) {
  Camera camera;
  KalibrLens lens{
      .camera_model = fields.text("camera_model"), .intrinsics = {}, .distortion_model = {}, .coefficients = {}};
  if (std::ranges::find(kKinds, lens.camera_model, &LensKind::camera_model) == kKinds.end()) {
    refuse_model(fields.place("camera_model"), lens.camera_model);
  }
  lens.distortion_model = fields.text("distortion_model");
  const auto kind = std::ranges::find_if(kKinds, [&](const LensKind& each) {
    return each.camera_model == lens.camera_model && each.distortion_model == lens.distortion_model;
  });
  if (kind == kKinds.end()) refuse_model(fields.place("distortion_model"), lens.distortion_model);
  read_resolution(fields, camera);
  lens.intrinsics = fields.numbers("intrinsics", kind->shape + 4);
  if (kind->distortion_model != "none") {
    lens.coefficients = fields.numbers(coefficients);
    const auto [least, most] = coefficient_counts(kind->model);
    if (lens.coefficients.size() < least || lens.coefficients.size() > most) fields.numbers(coefficients, least);
  }
  set_kalibr_lens(camera, lens, fields.place("intrinsics"));
  return camera;
}

Camera read_opencv_camera(const CalibrationFields& fields) {
  Camera camera;
  const bool is_fisheye = is_opencv_fisheye(fields);
  camera.width = fields.pixels("image_width");
  camera.height = fields.pixels("image_height");
  set_camera_matrix(camera, fields.numbers("camera_matrix", 9), fields.place("camera_matrix"));
  const bool is_ideal = fields.has("distortion_model") && fields.text("distortion_model") == "none";
  if (is_ideal && !fields.has("distortion_coefficients")) return camera;
  set_opencv_distortion(camera, fields.numbers("distortion_coefficients"), is_fisheye,
                        fields.place("distortion_coefficients"));
  return camera;
}

double read_readout_time(const CalibrationFields& fields, const Camera& camera) {
  constexpr double kLongest = 1.0;  // seconds
  for (const auto& [field, unit] : {std::pair("readout_time", 1.0), std::pair("line_delay", 1.0 * camera.height)}) {
    if (!fields.has(field)) continue;
    const std::optional<double> number = parse_number(fields.text(field));
    if (number && std::abs(*number * unit) <= kLongest) return *number * unit;
    throw InputError(fields.place(field), "is not a valid readout time",
                     "give seconds: line_delay per row, or readout_time for all rows");
  }
  return 0.0;
}

}  // namespace byre
