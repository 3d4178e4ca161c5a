#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"
#include "byre/io/calibration/format_readers.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Fields = CalibrationFields;
using Names = std::span<const std::string_view>;

// Letters and digits of a name, in small letters.
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      plain.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
    }
  }
  return plain;
}

// The first field with one of these plain names, after the side is cut off; empty if there is none.
std::string field_named(const Fields& fields, Names names, std::string_view side = {}) {
  for (const std::string& field : fields.names()) {
    const std::string plain = plain_name(field);
    for (const std::string_view name : names) {
      const bool is_longer = plain.size() == name.size() + side.size();
      const bool is_same = plain.starts_with(name) && plain.ends_with(side);
      if (is_longer && (is_same || (plain.starts_with(side) && plain.ends_with(name)))) return field;
    }
  }
  return {};
}

std::string field_named(const Fields& fields, std::initializer_list<std::string_view> names) {
  return field_named(fields, Names(names.begin(), names.size()));
}

void read_any_size(const Fields& fields, Camera& camera) {
  for (const std::string_view name : {"imagesize", "size", "resolution", "imgsize", "calibimagesize"}) {
    const std::string field = field_named(fields, {name});
    if (field.empty()) continue;
    if (fields.is_group(field)) {
      read_any_size(fields.group(field), camera);
      if (camera.width > 0) return;
    }
    const std::vector<double> sides = fields.numbers(field, 2);
    camera.width = to_image_side(sides[0], fields.place(field));
    camera.height = to_image_side(sides[1], fields.place(field));
    return;
  }
  if (fields.has("image_width") != fields.has("image_height"))
    return read_size(fields, "image_width", "image_height", camera);
  const std::string width =
      field_named(fields, {"imagewidth", "width", "camwidth", "framewidth", "imgwidth", "cols", "w"});
  const std::string height =
      field_named(fields, {"imageheight", "height", "camheight", "frameheight", "imgheight", "rows", "h"});
  if (!width.empty() && !height.empty()) read_size(fields, width, height, camera);
}

enum class LensName { opencv, fisheye, view_angle };

// Names of lens models in ROS, OpenCV, RealSense, SVO, DSO and NeRF.
LensName lens_name_of(const Fields& fields) {
  const std::string flag = field_named(fields, {"fisheyemodel", "fisheye", "isfisheye"});
  if (!flag.empty() && (fields.text(flag) == "1" || plain_name(fields.text(flag)) == "true")) return LensName::fisheye;
  const std::string field =
      field_named(fields, {"distortionmodel", "distortiontype", "model", "cammodel", "cameramodel", "projectionmodel"});
  if (field.empty()) return LensName::opencv;
  std::string name = plain_name(fields.text(field));
  if (name.starts_with("distortion")) name.erase(0, std::string_view("distortion").size());
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, name) != names.end();
  };
  if (is_one_of({"fisheye", "equidistant", "equi", "kannalabrandt", "kannalabrandt4", "opencvfisheye",
                 "equidistantcamera", "kb4"})) {
    return LensName::fisheye;
  }
  if (is_one_of({"atan", "fov"})) return LensName::view_angle;
  const bool is_opencv =
      is_one_of({"", "none", "pinhole", "simplepinhole", "perspective", "opencv", "fullopencv", "plumbbob", "radtan",
                 "radialtangential", "brown", "brownconrady", "modifiedbrownconrady", "inversebrownconrady",
                 "rectilinear", "rational", "rationalpolynomial"});
  // Another field than that of the distortion may name the product.
  const bool is_other = is_one_of({"equirectangular", "spherical", "cylindrical", "scaramuzza", "ocam", "mei", "omni",
                                   "unified", "ds", "doublesphere", "eucm", "division"});
  if (is_opencv || (!is_other && !plain_name(field).starts_with("distortion"))) return LensName::opencv;
  throw InputError(fields.place(field), "\"" + fields.text(field) + "\" is not supported",
                   "supported models: plumb_bob, rational_polynomial, equidistant, fisheye, pinhole, FOV");
}

// ---- Matrix and coefficients

constexpr std::array<std::string_view, 11> kMatrices = {
    "cameramatrix",     "k",    "m",         "mtx",       "matrix",    "intrinsicmatrix",
    "cameraintrinsics", "camk", "intmatrix", "intrinsic", "intrinsics"};
constexpr std::array<std::string_view, 17> kDistortions = {"distortioncoefficients",
                                                           "distortioncoeffs",
                                                           "distortioncoeff",
                                                           "distortioncoefs",
                                                           "distcoeffs",
                                                           "distcoeff",
                                                           "distcoefs",
                                                           "distcoef",
                                                           "distortcoeffs",
                                                           "distortcoeff",
                                                           "distortion",
                                                           "distortions",
                                                           "distortionparameters",
                                                           "dist",
                                                           "camdist",
                                                           "d",
                                                           "coeffs"};

std::string matrix_named(const Fields& fields, std::string_view side = {}) {
  const std::string field = field_named(fields, kMatrices, side);
  if (field.empty() || plain_name(field).find("cameramatrix") != std::string::npos) return field;
  return fields.has_numbers(field, 9) || fields.has_numbers(field, 12) ? field : std::string();
}

// The 3x3 part, row by row.
std::vector<double> matrix_of(const Fields& fields, const std::string& field) {
  std::vector<double> m = fields.numbers(field);
  if (m.size() == 12 && m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0) {
    m = {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
  }
  return m.size() == 9 ? m : fields.numbers(field, 9);
}

// A skew that moves pixels by less than a quarter of a pixel is left out.
void set_any_matrix(Camera& camera, std::vector<double> matrix, const std::string& place,
                    std::vector<std::string>& notes) {
  constexpr double kMostError = 0.25;  // pixels
  const bool is_by_columns = matrix[2] == 0.0 && matrix[5] == 0.0 && matrix[6] > 0.0 && matrix[7] > 0.0;
  if (is_by_columns) {
    std::swap(matrix[1], matrix[3]), std::swap(matrix[2], matrix[6]), std::swap(matrix[5], matrix[7]);
    notes.push_back(place + ": the matrix is stored column by column");
  }
  const double reach = std::max(matrix[5], camera.height - matrix[5]) / std::max(matrix[4], 1.0);
  if (const double error = std::abs(matrix[1]) * reach; matrix[1] != 0.0 && error < kMostError) {
    notes.push_back(fmt::format("{}: a skew of {:.3g} is left out, which moves pixels by at most {:.2g} pixels", place,
                                matrix[1], error));
    matrix[1] = 0.0;
  }
  set_camera_matrix(camera, matrix, place);
}

PlacedCamera matrix_camera(const Fields& fields, std::string_view side, std::vector<std::string>& notes) {
  constexpr std::size_t kAmbiguous = 4;
  PlacedCamera result;
  Camera& camera = result.camera;
  const std::string matrix = matrix_named(fields, side);
  const std::string distortion = field_named(fields, kDistortions, side);
  read_any_size(fields, camera);
  set_any_matrix(camera, matrix_of(fields, matrix), fields.place(matrix), notes);
  const LensName lens = lens_name_of(fields);
  if (distortion.empty()) {
    const std::string model = text_or(fields, "distortion_model", "none");
    if (model != "none") throw InputError(fields.place("distortion_coefficients"), "is missing");
    if (!fields.has("distortion_model")) notes.push_back("without distortion coefficients: undistorted images");
    return result;
  }
  const std::vector<double> coefficients = fields.numbers(distortion);
  set_opencv_distortion(camera, coefficients, lens == LensName::fisheye, fields.place(distortion));
  if (coefficients.size() == kAmbiguous && camera.model == CameraModel::radial_tangential &&
      !fields.has("distortion_model")) {
    notes.push_back(
        distortion +
        ": four coefficients are read as k1, k2, p1, p2; a fisheye needs \"distortion_model: equidistant\"");
  }
  return result;
}

// Sides in the names of a pair; empty if the file has none.
std::optional<std::pair<std::string_view, std::string_view>> sides_of_pair(const Fields& fields) {
  for (const auto& sides :
       {std::pair<std::string_view, std::string_view>{"1", "2"}, {"left", "right"}, {"l", "r"}, {"0", "1"}}) {
    if (!matrix_named(fields, sides.first).empty() && !matrix_named(fields, sides.second).empty()) return sides;
  }
  return std::nullopt;
}

// The pose of a pair in a file beside the one of its intrinsics.
std::optional<Pose> extrinsics_beside(const fs::path& path) {
  for (const char* const name : {"extrinsics.yml", "extrinsics.yaml", "extrinsics.xml"}) {
    const fs::path file = path.parent_path() / name;
    if (fs::is_regular_file(file)) return read_opencv_extrinsics(file);
  }
  return std::nullopt;
}

// ---- One field for each parameter

// Coefficients k1, k2, p1, p2, k3 to k6, or d0 to d7, with the prefix of the focal length.
std::vector<double> flat_coefficients(const Fields& fields, const std::string& prefix, bool is_fisheye) {
  const std::string list = field_named(fields, kDistortions);
  if (!list.empty()) return fields.numbers(list);
  constexpr std::array<std::string_view, 8> kOpencv = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  constexpr std::array<std::string_view, 4> kFisheye = {"k1", "k2", "k3", "k4"};
  constexpr std::array<std::string_view, 8> kNumbered = {"d0", "d1", "d2", "d3", "d4", "d5", "d6", "d7"};
  for (const Names names :
       {is_fisheye ? Names(kFisheye) : Names(kOpencv), is_fisheye ? Names(kNumbered).first(4) : Names(kNumbered)}) {
    if (!fields.has(prefix + std::string(names.front()))) continue;
    std::vector<double> numbers;
    for (const std::string_view name : names) numbers.push_back(fields.number_or(prefix + std::string(name), 0.0));
    return numbers;
  }
  return {};
}

std::array<std::string, 4> flat_names(const Fields& fields) {
  return {field_named(fields, {"fx", "camfx", "flx"}), field_named(fields, {"fy", "camfy", "fly"}),
          field_named(fields, {"cx", "camcx", "ppx"}), field_named(fields, {"cy", "camcy", "ppy"})};
}

}  // namespace

bool has_matrix_camera(const Fields& fields) {
  return !matrix_named(fields).empty();
}

CameraList read_matrix_camera(const Fields& fields, const fs::path&) {
  const bool is_ros = fields.has("projection_matrix") || (fields.has("distortion_model") && fields.has("P")) ||
                      (fields.has("distortion_model") && fields.has("p"));
  CameraList list{is_ros ? "ROS camera_info" : "OpenCV", {}};
  PlacedCamera camera = matrix_camera(fields, {}, list.notes);
  if (fields.has("T_BS")) camera.body_from_camera = fields.pose("T_BS");
  for (const auto& [rotation, projection] :
       {std::pair("rectification_matrix", "projection_matrix"), std::pair("R", "P"), std::pair("r", "p")}) {
    if (camera.rectified || !fields.has_numbers(projection, 12)) continue;
    camera.rectified = rectified_view(fields, rotation, projection);
    camera.pose_place = fields.place(projection);
  }
  camera.readout_time = read_readout_time(fields, camera.camera);
  list.cameras.push_back(camera);
  return list;
}

bool has_matrix_pair(const Fields& fields) {
  return sides_of_pair(fields).has_value();
}

CameraList read_matrix_pair(const Fields& fields, const fs::path& path) {
  const auto sides = *sides_of_pair(fields);
  CameraList list{"OpenCV stereo", {}};
  list.cameras = {matrix_camera(fields, sides.first, list.notes), matrix_camera(fields, sides.second, list.notes)};
  list.cameras[1].from_previous = pair_pose(fields);
  if (!list.cameras[1].from_previous) list.cameras[1].from_previous = extrinsics_beside(path);
  list.cameras[1].pose_place = fields.place("R, T");
  return list;
}

std::optional<Pose> pair_pose(const Fields& fields) {
  constexpr std::array kNames = {std::pair("R", "T"),
                                 std::pair("R", "t"),
                                 std::pair("r", "t"),
                                 std::pair("rotation", "translation"),
                                 std::pair("rotation_matrix", "translation_vector"),
                                 std::pair("rotation_left_to_right", "translation_left_to_right"),
                                 std::pair("om", "T")};
  for (const auto& [rotation_name, translation_name] : kNames) {
    if (!fields.has(rotation_name) || !fields.has(translation_name)) continue;
    const std::vector<double> numbers = fields.numbers(rotation_name);
    const std::vector<double> translation = fields.numbers(translation_name, 3);
    Pose pose{Eigen::Quaterniond::Identity(), Eigen::Vector3d(translation.data())};
    if (numbers.size() == 3) {
      pose.rotation = rotation_exp(Eigen::Vector3d(numbers.data()));
      return pose;
    }
    const auto rotation = rotation_from_matrix(fields.matrix(rotation_name));
    if (!rotation) throw InputError(fields.place(rotation_name), "is not a rotation", "give the matrix row by row");
    pose.rotation = *rotation;
    return pose;
  }
  return std::nullopt;
}

bool has_flat_camera(const Fields& fields) {
  return std::ranges::none_of(flat_names(fields), &std::string::empty);
}

CameraList read_flat_camera(const Fields& fields, const fs::path&) {
  CameraList list{"fields fx, fy, cx, cy", {}};
  PlacedCamera result;
  Camera& camera = result.camera;
  const std::array<std::string, 4> names = flat_names(fields);
  const std::string place = fields.place(names[0]);
  read_any_size(fields, camera);
  camera.fx = fields.number(names[0]), camera.fy = fields.number(names[1]);
  camera.cx = fields.number(names[2]), camera.cy = fields.number(names[3]);
  if (camera.cx < 1.0 && camera.cy < 1.0) {
    if (camera.width == 0) throw InputError(place, "is relative to the image size, which is missing");
    camera.fx *= camera.width, camera.fy *= camera.height;
    camera.cx = camera.cx * camera.width - 0.5, camera.cy = camera.cy * camera.height - 0.5;
    list.notes.push_back("intrinsics are relative to the image size");
  }
  require_valid(camera, place);
  const LensName lens = lens_name_of(fields);
  const std::string prefix = names[0].starts_with("cam_") ? "cam_" : "";
  std::vector<double> coefficients = flat_coefficients(fields, prefix, lens == LensName::fisheye);
  if (lens == LensName::view_angle) {
    coefficients.resize(1, 0.0);
    set_kalibr_lens(camera, {"pinhole", {camera.fx, camera.fy, camera.cx, camera.cy}, "fov", coefficients}, place);
  } else if (!coefficients.empty()) {
    set_opencv_distortion(camera, coefficients, lens == LensName::fisheye, place);
  } else {
    list.notes.push_back("without distortion coefficients: undistorted images");
  }
  const std::string model = field_named(fields, {"model", "distortionmodel"});
  if (camera.model != CameraModel::pinhole && !model.empty() &&
      plain_name(fields.text(model)).ends_with("inversebrownconrady")) {
    throw InputError(fields.place(model), "an inverse model with distortion is not supported",
                     "calibrate the camera with one of the models of OpenCV");
  }
  list.cameras.push_back(result);
  return list;
}

}  // namespace byre
