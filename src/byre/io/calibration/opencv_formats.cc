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
    if (!fields.has(field)) continue;
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

constexpr std::array<std::string_view, 21> kDistortions = {"distortioncoefficients",
                                                           "distortioncofficients",
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
                                                           "distortionparams",
                                                           "lensdistortion",
                                                           "dist",
                                                           "camdist",
                                                           "d",
                                                           "coeffs",
                                                           "coefficients"};

constexpr std::array<std::string_view, 8> kSizes = {
    "imagesize", "size", "resolution", "imgsize", "calibimagesize", "imageresolution", "imageshape", "imagedimension"};
constexpr std::array<std::string_view, 9> kWidths = {
    "imagewidth", "width", "camwidth", "cameraimagewidth", "resolutionwidth", "framewidth", "imgwidth", "cols", "w"};
constexpr std::array<std::string_view, 9> kHeights = {
    "imageheight", "height", "camheight", "cameraimageheight", "resolutionheight", "frameheight",
    "imgheight",   "rows",   "h"};
constexpr std::array<std::string_view, 3> kFisheyeFlags = {"fisheyemodel", "fisheye", "isfisheye"};
constexpr std::array<std::string_view, 11> kModels = {
    "distortionmodel", "distmodel",  "distortiontype", "model",    "cammodel", "cameramodel",
    "projectionmodel", "cameratype", "lensmodel",      "lenstype", "type"};
// Poses of a camera in the body, and of the body in a camera.
constexpr std::array<std::string_view, 6> kBodyPoses = {"tbs", "timucam", "tbc", "tsc", "tbodycam", "bodytcam"};
constexpr std::array<std::string_view, 4> kCameraPoses = {"tcamimu", "tcb", "tcambody", "tcs"};

void read_any_size(const Fields& fields, Camera& camera, std::string_view side = {}) {
  for (const std::string_view name : kSizes) {
    std::string field = field_named(fields, Names(&name, 1), side);
    if (field.empty()) field = field_named(fields, {name});
    if (field.empty()) continue;
    if (fields.is_group(field) && !fields.group(field).has("data")) {
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
  const std::string width = field_named(fields, kWidths), height = field_named(fields, kHeights);
  if (!width.empty() && !height.empty()) read_size(fields, width, height, camera);
}

enum class LensName { opencv, none, fisheye, view_angle };

// Field that names the lens model, of the distortion if there are several; empty without.
std::string model_named(const Fields& fields, std::string_view side) {
  for (const std::string_view name : kModels) {
    for (const std::string_view each : {side, std::string_view()}) {
      const std::string field = field_named(fields, Names(&name, 1), each);
      if (fields.has_scalar(field)) return field;
    }
  }
  return {};
}

// Names of lens models in ROS, OpenCV, RealSense, SVO, DSO and NeRF.
LensName lens_name_of(const Fields& fields, std::string_view side = {}) {
  const std::string flag = field_named(fields, kFisheyeFlags);
  if (fields.has_scalar(flag) && (fields.text(flag) == "1" || plain_name(fields.text(flag)) == "true"))
    return LensName::fisheye;
  const std::string group = field_named(fields, kDistortions);
  if (fields.is_group(group) && !model_named(fields.group(group), {}).empty()) return lens_name_of(fields.group(group));
  const std::string field = model_named(fields, side);
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
  if (is_one_of({"none", "ideal", "undistorted"})) return LensName::none;
  const bool is_opencv = is_one_of({"", "pinhole", "simplepinhole", "perspective", "opencv", "fullopencv", "plumbbob",
                                    "radtan", "radialtangential", "brown", "brownconrady", "modifiedbrownconrady",
                                    "inversebrownconrady", "rectilinear", "rational", "rationalpolynomial"});
  // Another field than that of the distortion may name the product.
  const bool is_other = is_one_of({"equirectangular", "spherical", "cylindrical", "scaramuzza", "ocam", "mei", "omni",
                                   "unified", "ds", "doublesphere", "eucm", "division"});
  if (is_opencv || (!is_other && !plain_name(field).starts_with("distortion"))) return LensName::opencv;
  throw InputError(fields.place(field), "\"" + fields.text(field) + "\" is not supported",
                   "supported models: plumb_bob, rational_polynomial, equidistant, fisheye, pinhole, FOV");
}

// ---- Matrix and coefficients

constexpr std::array<std::string_view, 14> kMatrices = {
    "cameramatrix",     "k",    "m",         "mtx",       "matrix",     "intrinsicmatrix", "intrinsicparameters",
    "cameraintrinsics", "camk", "intmatrix", "intrinsic", "intrinsics", "kmatrix",         "intrinsicsmatrix"};
std::string matrix_named(const Fields& fields, std::string_view side = {}) {
  const std::string field = field_named(fields, kMatrices, side);
  if (field.empty()) return field;
  const bool is_named = plain_name(field).find("cameramatrix") != std::string::npos;
  if (is_named && (!fields.is_group(field) || !has_flat_camera(fields.group(field)))) return field;
  return fields.has_numbers(field, 9) || fields.has_numbers(field, 12) ? field : std::string();
}

constexpr std::array<std::string_view, 9> kVectors = {
    "intrinsics",    "intrinsic",        "intrinsicparams",      "intrinsicparameters", "cameraintrinsics",
    "camintrinsics", "cameraparameters", "projectionparameters", "calibration"};

// Field with fx, fy, cx, cy, which may be followed by k1, k2, p1, p2 and k3; empty if there is none.
std::string vector_named(const Fields& fields, std::string_view side = {}) {
  constexpr double kMostRatio = 1.5;  // larger focal length over the smaller one
  for (const std::string_view name : kVectors) {
    const std::string field = field_named(fields, Names(&name, 1), side);
    if (field.empty() ||
        !(fields.has_numbers(field, 4) || fields.has_numbers(field, 8) || fields.has_numbers(field, 9)))
      continue;
    const std::vector<double> numbers = fields.numbers(field);
    const bool is_plausible = numbers[0] > 0.0 && numbers[1] > 0.0 && numbers[0] < kMostRatio * numbers[1] &&
                              numbers[1] < kMostRatio * numbers[0];
    if (is_plausible) return field;
  }
  return {};
}

// The 3x3 part, row by row.
std::vector<double> matrix_of(const Fields& fields, const std::string& field) {
  std::vector<double> m = fields.numbers(field);
  if (m.size() == 12 && m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0) {
    m = {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
  }
  return m.size() == 9 ? m : fields.numbers(field, 9);
}

// Sets intrinsics that are given as shares of the image size, of the images if the file does not have it.
void scale_intrinsics(const Fields& fields, Camera& camera, double fx, double fy, double cx, double cy,
                      const std::string& place) {
  if (camera.width == 0 && fields.has(kSizeOfImages)) {
    const std::vector<double> size = fields.numbers(kSizeOfImages, 2);
    camera.width = to_image_side(size[0], place);
    camera.height = to_image_side(size[1], place);
  }
  if (camera.width == 0) {
    throw InputError(place, "is relative to the image size, which is missing", "give --size WIDTHxHEIGHT");
  }
  camera.fx = fx * camera.width, camera.fy = fy * camera.height;
  camera.cx = cx * camera.width - 0.5, camera.cy = cy * camera.height - 0.5;
}

void set_any_matrix(const Fields& fields, Camera& camera, std::vector<double> matrix, const std::string& place,
                    std::vector<std::string>& notes) {
  const bool is_by_columns = matrix[2] == 0.0 && matrix[5] == 0.0 && matrix[6] > 0.0 && matrix[7] > 0.0;
  if (is_by_columns) {
    std::swap(matrix[1], matrix[3]), std::swap(matrix[2], matrix[6]), std::swap(matrix[5], matrix[7]);
    notes.push_back(place + ": the matrix is stored column by column");
  }
  const bool is_relative = matrix[8] == 1.0 && matrix[2] < 1.0 && matrix[5] < 1.0 && matrix[0] < 10.0;
  if (is_relative) {
    scale_intrinsics(fields, camera, matrix[0], matrix[4], matrix[2], matrix[5], place);
    matrix = {camera.fx, matrix[1] * camera.width, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
    notes.push_back(place + ": intrinsics are relative to the image size");
  }
  set_skewed_matrix(camera, matrix, place, notes);
}

// Field of one parameter, also behind the prefixes of other programs.
std::string field_of(const Fields& fields, const std::string& name) {
  for (const char* const prefix : {"", "cam", "camera", "dist", "radial", "tangential"}) {
    const std::string plain = prefix + name;
    const std::string field = field_named(fields, {std::string_view(plain)});
    if (!field.empty()) return field;
  }
  if (name == "k1") return field_named(fields, {"kud"});  // ViSP
  return {};
}

// Coefficients of a list, or of fields k1, k2, p1, p2, k3 to k6, or d0 to d7. Throws InputError for a group of others.
std::vector<double> coefficients_in(const Fields& fields, bool is_fisheye) {
  const std::string list = field_named(fields, kDistortions);
  if (!list.empty() && fields.is_group(list) && !fields.group(list).has("data")) {
    const Fields group = fields.group(list);
    std::vector<double> numbers = coefficients_in(group, is_fisheye);
    if (numbers.empty() && lens_name_of(group) != LensName::none) {
      throw InputError(fields.place(list), "has no coefficients k1, k2 or a list of them");
    }
    return numbers;
  }
  if (!list.empty()) return fields.numbers(list);
  constexpr std::array<std::string_view, 8> kOpencv = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  constexpr std::array<std::string_view, 4> kFisheye = {"k1", "k2", "k3", "k4"};
  constexpr std::array<std::string_view, 8> kNumbered = {"d0", "d1", "d2", "d3", "d4", "d5", "d6", "d7"};
  // LARVIO names the coefficients of a fisheye as those of OpenCV.
  const bool is_renamed = is_fisheye && field_of(fields, "k3").empty() && !field_of(fields, "p1").empty();
  for (const Names names : {is_renamed   ? Names(kOpencv).first(4)
                            : is_fisheye ? Names(kFisheye)
                                         : Names(kOpencv),
                            is_fisheye ? Names(kNumbered).first(4) : Names(kNumbered)}) {
    if (field_of(fields, std::string(names.front())).empty()) continue;
    std::vector<double> numbers;
    for (const std::string_view name : names) {
      const std::string field = field_of(fields, std::string(name));
      numbers.push_back(field.empty() ? 0.0 : fields.number(field));
    }
    return numbers;
  }
  return {};
}

// Throws InputError for numbers of a distortion whose name is unknown, which must not pass for undistorted images.
void refuse_unknown_distortion(const Fields& fields) {
  for (const auto& name : fields.names()) {
    const std::string plain = plain_name(name);
    const bool is_distortion =
        plain.find("distortion") != std::string::npos || plain.starts_with("distco") || plain.starts_with("radial");
    if (is_distortion && fields.has(name) && (fields.is_group(name) || fields.has_list(name))) {
      throw InputError(fields.place(name), "is a distortion of an unknown form",
                       "name the coefficients k1, k2, p1, p2, k3 \"distortion_coefficients\"");
    }
  }
}

PlacedCamera matrix_camera(const Fields& fields, std::string_view side, std::vector<std::string>& notes) {
  constexpr std::size_t kIntrinsics = 4, kAmbiguous = 4;
  PlacedCamera result;
  Camera& camera = result.camera;
  std::string matrix = matrix_named(fields, side);
  const std::string distortion = field_named(fields, kDistortions, side);
  read_any_size(fields, camera, side);
  std::vector<double> coefficients;
  const LensName lens = lens_name_of(fields, side);
  if (!matrix.empty()) {
    set_any_matrix(fields, camera, matrix_of(fields, matrix), fields.place(matrix), notes);
  } else {
    matrix = vector_named(fields, side);
    const std::vector<double> numbers = fields.numbers(matrix);
    set_any_matrix(fields, camera, {numbers[0], 0.0, numbers[2], 0.0, numbers[1], numbers[3], 0.0, 0.0, 1.0},
                   fields.place(matrix), notes);
    coefficients.assign(numbers.begin() + kIntrinsics, numbers.end());
    notes.push_back(matrix + ": the numbers are read as fx, fy, cx, cy" +
                    (coefficients.empty() ? "" : ", k1, k2, p1, p2"));
  }
  if (distortion.empty() && coefficients.empty()) {
    const std::string model = text_or(fields, "distortion_model", "none");
    refuse_unknown_distortion(fields);
    if (model != "none") throw InputError(fields.place("distortion_coefficients"), "is missing");
    if (!fields.has("distortion_model")) notes.push_back("without distortion coefficients: undistorted images");
    return result;
  }
  const bool is_fisheye = lens == LensName::fisheye;
  if (!distortion.empty()) {
    const bool is_group = fields.is_group(distortion) && !fields.group(distortion).has("data");
    coefficients = is_group ? coefficients_in(fields, is_fisheye) : fields.numbers(distortion);
  }
  set_opencv_distortion(camera, coefficients, is_fisheye, fields.place(distortion.empty() ? matrix : distortion));
  if (coefficients.size() == kAmbiguous && camera.model == CameraModel::radial_tangential &&
      !fields.has("distortion_model")) {
    notes.push_back(
        distortion +
        ": four coefficients are read as k1, k2, p1, p2; a fisheye needs \"distortion_model: equidistant\"");
  }
  return result;
}

constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kSides = {
    {{"1", "2"}, {"left", "right"}, {"l", "r"}, {"0", "1"}}};

// Sides in the names of a pair; empty if the file has none.
std::optional<std::pair<std::string_view, std::string_view>> sides_of_pair(const Fields& fields) {
  for (const auto& sides : kSides) {
    if (!matrix_named(fields, sides.first).empty() && !matrix_named(fields, sides.second).empty()) return sides;
  }
  for (const auto& sides : kSides) {
    if (!vector_named(fields, sides.first).empty() && !vector_named(fields, sides.second).empty()) return sides;
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

std::array<std::string, 4> flat_names(const Fields& fields) {
  return {field_named(fields, {"fx", "camfx", "flx", "camerafx", "focallengthx", "focalx", "fu", "px"}),
          field_named(fields, {"fy", "camfy", "fly", "camerafy", "focallengthy", "focaly", "fv", "py"}),
          field_named(fields, {"cx", "camcx", "ppx", "cameracx", "centerx", "principalpointx", "u0", "camu0", "cu"}),
          field_named(fields, {"cy", "camcy", "ppy", "cameracy", "centery", "principalpointy", "v0", "camv0", "cv"})};
}

}  // namespace

bool is_shared_field(std::string_view name) {
  const std::string plain = plain_name(name);
  const auto contains = [&](Names names) { return std::ranges::find(names, plain) != names.end(); };
  return contains(kDistortions) || contains(kSizes) || contains(kWidths) || contains(kHeights) || contains(kModels) ||
         contains(kFisheyeFlags) || name == kSizeOfImages || contains(kBodyPoses) || contains(kCameraPoses);
}

Fields with_affix_groups(const Fields& fields) {
  constexpr std::array<std::string_view, 9> kCameras = {
      "k",        "mtx",        "cameramatrix",         "intrinsicmatrix",
      "kmatrix",  "intrinsics", "projectionparameters", "cameraintrinsics",
      "intrinsic"};
  const std::vector<std::string> all = fields.names();
  std::vector<std::string> affixes;
  for (const std::string& name : all) {
    const bool is_group = fields.is_group(name) && has_flat_camera(fields.group(name));
    const bool is_camera = is_group || fields.has_numbers(name, 9) || fields.has_numbers(name, 4);
    for (std::size_t at = name.find('_'); is_camera && at != std::string::npos; at = name.find('_', at + 1)) {
      const std::string first = name.substr(0, at), second = name.substr(at + 1);
      for (const auto& [affix, rest] : {std::pair(first, second), std::pair(second, first)}) {
        const bool is_of_camera = std::ranges::find(kCameras, plain_name(rest)) != kCameras.end();
        const bool is_new = std::ranges::find(affixes, affix) == affixes.end();
        const auto is_named = [&](const std::string& other) {
          return other.starts_with(affix + "_") || other.ends_with("_" + affix);
        };
        const bool is_alone = is_group && std::ranges::count_if(all, is_named) < 2;
        if (is_of_camera && is_new && !is_alone && !affix.empty() && !fields.has(affix)) affixes.push_back(affix);
      }
    }
  }
  return affixes.empty() ? fields : fields.grouped_by(affixes);
}

bool has_matrix_camera(const Fields& fields) {
  return !matrix_named(fields).empty();
}

CameraList read_matrix_camera(const Fields& fields, const fs::path&) {
  const bool is_ros = fields.has("projection_matrix") || (fields.has("distortion_model") && fields.has("P")) ||
                      (fields.has("distortion_model") && fields.has("p"));
  CameraList list{is_ros ? "ROS camera_info" : "OpenCV", {}};
  PlacedCamera camera = matrix_camera(fields, {}, list.notes);
  camera.body_from_camera = body_pose(fields);
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

bool has_vector_camera(const Fields& fields) {
  return !vector_named(fields).empty();
}

void place_pair(const Fields& fields, PlacedCamera& left, PlacedCamera& right) {
  right.from_previous = pair_pose(fields);
  for (const auto& [first, second] : kSides) {
    const auto left_pose = body_pose(fields, first), right_pose = body_pose(fields, second);
    if (right.from_previous || !left_pose || !right_pose) continue;
    left.body_from_camera = left_pose;
    right.body_from_camera = right_pose;
    return;
  }
}

std::optional<Pose> body_pose(const Fields& fields, std::string_view side) {
  const auto is_pose = [&](const std::string& field) {
    return !field.empty() && (fields.has_numbers(field, 16) || fields.has_numbers(field, 12));
  };
  if (const std::string field = field_named(fields, kBodyPoses, side); is_pose(field)) return fields.pose(field);
  if (const std::string field = field_named(fields, kCameraPoses, side); is_pose(field)) {
    return inverse(fields.pose(field));
  }
  return std::nullopt;
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
  list.cameras[0].body_from_camera = body_pose(fields, sides.first);
  list.cameras[1].body_from_camera = body_pose(fields, sides.second);
  list.cameras[1].pose_place = fields.place("R, T");
  return list;
}

std::optional<Pose> pair_pose(const Fields& fields) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kNames = {
      {{"r", "t"},
       {"rotation", "translation"},
       {"rotationmatrix", "translationvector"},
       {"rotationmatrix", "translationmatrix"},
       {"rotationmatrix", "translation"},
       {"rotationlefttoright", "translationlefttoright"},
       {"rstereo", "tstereo"},
       {"stereor", "stereot"},
       {"om", "t"}}};
  for (const auto& [rotation_names, translation_names] : kNames) {
    const std::string rotation_name = field_named(fields, {rotation_names});
    const std::string translation_name = field_named(fields, {translation_names});
    if (rotation_name.empty() || translation_name.empty()) continue;
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
    scale_intrinsics(fields, camera, camera.fx, camera.fy, camera.cx, camera.cy, place);
    list.notes.push_back("intrinsics are relative to the image size");
  }
  result.body_from_camera = body_pose(fields);
  require_valid(camera, place);
  const LensName lens = lens_name_of(fields);
  std::vector<double> coefficients = coefficients_in(fields, lens == LensName::fisheye);
  if (lens == LensName::view_angle) {
    coefficients.resize(1, 0.0);
    set_kalibr_lens(camera, {"pinhole", {camera.fx, camera.fy, camera.cx, camera.cy}, "fov", coefficients}, place);
  } else if (!coefficients.empty()) {
    set_opencv_distortion(camera, coefficients, lens == LensName::fisheye, place);
  } else {
    refuse_unknown_distortion(fields);
    list.notes.push_back("without distortion coefficients: undistorted images");
  }
  const std::string model = model_named(fields, {});
  if (camera.model != CameraModel::pinhole && !model.empty() &&
      plain_name(fields.text(model)).ends_with("inversebrownconrady")) {
    throw InputError(fields.place(model), "an inverse model with distortion is not supported",
                     "calibrate the camera with one of the models of OpenCV");
  }
  list.cameras.push_back(result);
  return list;
}

}  // namespace byre
