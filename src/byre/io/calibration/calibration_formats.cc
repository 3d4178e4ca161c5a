#include "byre/io/calibration/calibration_formats.h"

#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"
#include "byre/io/calibration/format_readers.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Fields = CalibrationFields;

// ---- Kalibr, OpenVINS, EuRoC

PlacedCamera kalibr_camera(const Fields& fields) {
  const bool is_kalibr = fields.has("distortion_coeffs");
  PlacedCamera result{read_camera_fields(fields, is_kalibr ? "distortion_coeffs" : "distortion_coefficients")};
  if (fields.has("T_BS")) result.body_from_camera = fields.pose("T_BS");
  if (fields.has("T_cam_imu")) result.body_from_camera = inverse(fields.pose("T_cam_imu"));
  if (fields.has("T_imu_cam")) result.body_from_camera = fields.pose("T_imu_cam");
  if (fields.has("T_cn_cnm1")) result.from_previous = fields.pose("T_cn_cnm1");
  result.readout_time = read_readout_time(fields, result.camera);
  result.pose_place = fields.place(is_kalibr ? "T_cn_cnm1" : "T_BS");
  return result;
}

CameraList kalibr_cameras(const Fields& fields, const fs::path&) {
  CameraList list{fields.has("cam0") && fields.group("cam0").has("T_imu_cam") ? "OpenVINS" : "Kalibr camchain",
                  {kalibr_camera(fields.group("cam0"))}};
  if (fields.has("cam1")) list.cameras.push_back(kalibr_camera(fields.group("cam1")));
  if (fields.has("cam2")) list.notes.push_back("cameras after cam1 are not used");
  return list;
}

CameraList openvins_config(const Fields& fields, const fs::path& path) {
  CameraList list = read_cameras(path.parent_path() / fields.text("relative_config_imucam"));
  list.format = "OpenVINS";
  return list;
}

CameraList sensor_camera(const Fields& fields, const fs::path&) {
  return {fields.has("distortion_coeffs") ? "Kalibr camchain" : "EuRoC sensor.yaml", {kalibr_camera(fields)}};
}

CameraList ros_ini_pair(const Fields& fields, const fs::path& path) {
  CameraList list = read_matrix_camera(fields.group("left"), path);
  list.cameras.push_back(read_matrix_camera(fields.group("right"), path).cameras.front());
  return list;
}

// ---- The formats, by their content

struct Format {
  bool (*matches)(const Fields&);
  FormatReader read;
  bool is_nested = false;  // read inside other fields as well
};

bool has_camera_fields(const Fields& fields) {
  return fields.has_list("intrinsics") && (fields.has("camera_model") || fields.has("distortion_coeffs"));
}

// Whether a field holds a camera of another format than Kalibr's.
bool is_plain_camera(const Fields& fields, const std::string& name) {
  return fields.is_group(name) && (has_matrix_camera(fields.group(name)) || has_flat_camera(fields.group(name)));
}

constexpr std::array kFormats = {
    Format{[](const Fields& f) { return f.has_numbers("cam0", 9) && f.has_numbers("cam1", 9) && f.has("baseline"); },
           read_middlebury},
    Format{[](const Fields& f) { return f.has("projection_type") && f.has("width"); }, read_opensfm, true},
    Format{[](const Fields& f) { return f.is_group("CameraParameters1") && f.is_group("CameraParameters2"); },
           read_matlab_pair, true},
    Format{has_matlab_camera, read_matlab, true},
    Format{[](const Fields& f) { return f.has("fc") || (f.has("fc_left") && f.has("fc_right")); }, read_bouguet},
    Format{has_metashape_camera, read_metashape, true},
    Format{[](const Fields& f) { return f.has("sfm_data_version"); }, read_openmvg},
    Format{[](const Fields& f) { return f.has("cam0") && !is_plain_camera(f, "cam0"); }, kalibr_cameras, true},
    Format{[](const Fields& f) { return f.has("relative_config_imucam"); }, openvins_config},
    Format{[](const Fields& f) { return f.has("value0"); }, read_basalt},
    Format{[](const Fields& f) { return f.has("cam0_calib"); }, read_vins_rig},
    Format{[](const Fields& f) { return f.has("model_type"); }, read_vins_camera},
    Format{[](const Fields& f) { return f.has("cameraData"); }, read_depthai},
    Format{[](const Fields& f) { return (f.has("cameras") && !f.is_group("cameras")) || f.has("ncameras"); },
           read_camera_list},
    Format{[](const Fields& f) {
             return (f.is_group("Camera") && f.group("Camera").has("fx")) || f.has("Camera.setup") ||
                    f.has("Camera.model") || (f.is_group("Camera") && f.group("Camera").has("model"));
           },
           read_stella},
    Format{[](const Fields& f) {
             return f.has("Camera.fx") || f.has("Camera1.fx") || f.has("LEFT.K") || f.has("Camera.type");
           },
           read_orb_slam},
    Format{[](const Fields& f) { return f.has("P0") || f.has("P_rect_00") || f.has_numbers("P2", 12); }, read_kitti},
    Format{has_matrix_pair, read_matrix_pair, true},
    Format{has_matrix_camera, read_matrix_camera, true},
    Format{[](const Fields& f) {
             return f.is_group("left") && f.is_group("right") && f.group("left").has("projection_matrix");
           },
           ros_ini_pair},
    Format{has_camera_fields, sensor_camera, true},
    Format{[](const Fields& f) {
             return f.has("image_width") && f.has("image_height") && f.has("type") && f.has("intrinsics");
           },
           read_maplab_camera},
    Format{has_flat_camera, read_flat_camera, true},
    Format{has_vector_camera, read_matrix_camera, true},
};

std::string small_letters(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// Whether a name has one of these words, between other signs than letters.
bool has_word(std::string_view name, std::initializer_list<std::string_view> words) {
  const std::string lower = small_letters(name);
  const auto is_letter = [&](std::size_t at) {
    return at < lower.size() && std::isalpha(static_cast<unsigned char>(lower[at])) != 0;
  };
  return std::ranges::any_of(words, [&](std::string_view word) {
    const std::size_t at = lower.find(word);
    return at != std::string::npos && (at == 0 || !is_letter(at - 1)) && !is_letter(at + word.size());
  });
}

// Names of the sides of a pair, as in cam0 and cam1, camera_left and camera_right: 0, 1, or neither.
std::optional<int> side_of(std::string_view name) {
  const std::string lower = small_letters(name);
  const bool is_left = lower.find("left") != std::string::npos;
  if (is_left || lower.find("right") != std::string::npos) return is_left ? 0 : 1;
  if (lower.ends_with('0') || lower.ends_with("[0]")) return 0;
  if (lower.ends_with('1') || lower.ends_with("[1]")) return 1;
  return std::nullopt;
}

using FoundCameras = std::vector<std::pair<std::string, CameraList>>;

// Keeps one of the entries of a list that repeats a camera for each image, as "frames" of NeRF.
void keep_one_of_equals(FoundCameras& found) {
  const std::string_view first = found.front().first;
  const bool is_list = found.size() > 1 && first.ends_with("[0]");
  const bool is_repeated =
      is_list && std::ranges::all_of(found, [&](const auto& each) {
        return each.second.cameras.size() == 1 && each.second.cameras[0].camera == found[0].second.cameras[0].camera;
      });
  if (!is_repeated || (found.size() == 2 && !first.starts_with("frames"))) return;
  found[0].second.notes.push_back(fmt::format("{} entries have the same camera", found.size()));
  found.erase(found.begin() + 1, found.end());
}

// Keeps the model with distortion of the two that ViSP has for one camera.
void keep_the_distorted_model(FoundCameras& found) {
  const bool is_visp = found.size() == 2 && found[0].first == "model" && found[1].first.starts_with("model_");
  if (!is_visp) return;
  std::erase_if(found, [](const auto& each) { return each.second.cameras[0].camera.model == CameraModel::pinhole; });
}

// Keeps the colour camera of a device that has other kinds of cameras next to it.
void keep_the_colour_camera(FoundCameras& found) {
  const auto is_colour = [](const auto& each) { return has_word(each.first, {"color", "colour", "rgb"}); };
  const auto is_other = [](const auto& each) {
    return has_word(each.first, {"depth", "ir", "infra", "thermal", "tof"});
  };
  const auto colour = std::ranges::find_if(found, is_colour);
  if (colour == found.end() || std::ranges::count_if(found, is_colour) != 1 || found.size() < 2 ||
      static_cast<std::size_t>(std::ranges::count_if(found, is_other)) != found.size() - 1) {
    return;
  }
  std::swap(found.front(), *colour);
  found[0].second.notes.push_back(fmt::format("of {} cameras, {} is used", found.size(), found[0].first));
  found.erase(found.begin() + 1, found.end());
}

[[noreturn]] void refuse_many_cameras(const fs::path& path, const std::vector<std::string>& names) {
  throw InputError(path.string(), fmt::format("has {} cameras: {}", names.size(), fmt::join(names, ", ")),
                   "give a file of one camera or of a stereo pair");
}

// Cameras inside other fields: the only camera or pair, or the left and right of two. Empty if there is none.
// own: fields without those of the groups around them.
std::optional<CameraList> nested_cameras(const Fields& own, const Fields& fields, const fs::path& path) {
  FoundCameras found;
  for (const auto& [name, inner] : own.inner()) {
    const Fields group = inner.completed(fields, is_shared_field);
    const auto format =
        std::ranges::find_if(kFormats, [&](const Format& each) { return each.is_nested && each.matches(inner); });
    if (format != kFormats.end()) {
      found.emplace_back(name, format->read(group, path));
    } else if (auto list = nested_cameras(inner, group, path)) {
      found.emplace_back(name, std::move(*list));
    }
  }
  if (found.empty()) return std::nullopt;
  keep_one_of_equals(found);
  keep_the_distorted_model(found);
  if (found.empty()) return std::nullopt;
  keep_the_colour_camera(found);
  if (found.size() == 2 && found[0].second.cameras[0].camera == found[1].second.cameras[0].camera &&
      !side_of(found[1].first)) {
    found.pop_back();  // one camera, in two notations
  }
  if (found.size() == 1) return std::move(found.front().second);
  std::vector<std::string> names;
  for (const auto& [name, list] : found) names.push_back(name);
  if (found.size() > 2 && !found.front().first.ends_with(']'))
    std::erase_if(found, [](const auto& each) { return !side_of(each.first); });
  const bool is_pair = found.size() == 2 && found[0].second.cameras.size() == 1 && found[1].second.cameras.size() == 1;
  if (!is_pair) refuse_many_cameras(path, names);
  if (side_of(found[0].first).value_or(0) > side_of(found[1].first).value_or(1)) std::swap(found[0], found[1]);
  CameraList list = std::move(found[0].second);
  list.cameras.push_back(found[1].second.cameras.front());
  list.notes.insert(list.notes.end(), found[1].second.notes.begin(), found[1].second.notes.end());
  if (!list.cameras[1].from_previous) place_pair(fields, list.cameras[0], list.cameras[1]);
  const bool is_placed = list.cameras[1].from_previous || list.cameras[1].rectified || list.cameras[1].body_from_camera;
  if (names.size() > 2 && !is_placed) refuse_many_cameras(path, names);
  if (list.cameras[1].pose_place.empty()) list.cameras[1].pose_place = fields.place("R, T");
  if (names.size() > 2)
    list.notes.push_back(fmt::format("of {} cameras, a left and a right one are used", names.size()));
  return list;
}

}  // namespace

Pose baseline_pose(double x, double y) {
  return {Eigen::Quaterniond::Identity(), {x, y, 0.0}};
}

std::string text_or(const Fields& fields, const std::string& field, const std::string& otherwise) {
  return fields.has(field) ? fields.text(field) : otherwise;
}

bool has_all(const Fields& fields, std::initializer_list<const char*> names) {
  return std::ranges::all_of(names, [&](const char* name) { return fields.has(name); });
}

void read_size(const Fields& fields, const std::string& width, const std::string& height, Camera& camera) {
  if (!fields.has(width) && !fields.has(height)) return;
  camera.width = fields.pixels(width);
  camera.height = fields.pixels(height);
}

std::vector<double> coefficients_of(const Fields& fields, const std::string& prefix,
                                    std::initializer_list<const char*> names) {
  std::vector<double> result;
  for (const char* const name : names) result.push_back(fields.number_or(prefix + name, 0.0));
  return result;
}

void set_intrinsics(const Fields& fields, const std::array<std::string, 4>& names, Camera& camera) {
  camera.fx = fields.number(names[0]), camera.fy = fields.number(names[1]);
  camera.cx = fields.number(names[2]), camera.cy = fields.number(names[3]);
  require_valid(camera, fields.place(names[0]));
}

std::optional<RectifiedView> rectified_view(const Fields& fields, const std::string& rotation,
                                            const std::string& projection) {
  if (!fields.has(rotation) || !fields.has(projection)) return std::nullopt;
  RectifiedView view{fields.matrix(rotation)};
  view.projection = Eigen::Map<const decltype(view.projection)>(fields.numbers(projection, 12).data());
  return view;
}

std::optional<Pose> right_from_left(const RectifiedView& left, const RectifiedView& right) {
  const auto shift = [](const RectifiedView& view) -> std::optional<Eigen::Vector2d> {
    const auto& p = view.projection;
    if (p(0, 3) == 0.0 && p(1, 3) == 0.0) return Eigen::Vector2d(0.0, 0.0);
    if (!(p(0, 0) > 0.0) || !(p(1, 1) > 0.0)) return std::nullopt;
    return Eigen::Vector2d(p(0, 3) / p(0, 0), p(1, 3) / p(1, 1));
  };
  const auto left_shift = shift(left);
  const auto right_shift = shift(right);
  const auto left_rotation = rotation_from_matrix(left.rotation);
  const auto right_rotation = rotation_from_matrix(right.rotation);
  if (!left_shift || !right_shift || !left_rotation || !right_rotation) return std::nullopt;
  const Eigen::Vector2d between = *right_shift - *left_shift;
  if (between == Eigen::Vector2d::Zero()) return std::nullopt;
  const Pose rectified_from_left{*left_rotation, Eigen::Vector3d::Zero()};
  const Pose rectified_from_right{*right_rotation, Eigen::Vector3d::Zero()};
  return inverse(rectified_from_right) * baseline_pose(between.x(), between.y()) * rectified_from_left;
}

std::optional<Pose> read_opencv_extrinsics(const fs::path& path) {
  return pair_pose(CalibrationFields::load(path));
}

CameraList read_cameras(const fs::path& path, std::optional<std::pair<int, int>> size) {
  CalibrationFields fields = CalibrationFields::load(path);
  if (size) fields.set_size_of_images(size->first, size->second);
  if (fields.has("STEREO") && fields.is_group("STEREO")) return read_zed(fields, size);
  if (fields.has("colmap")) return read_colmap(fields, path);
  if (fields.has("ocam")) {
    throw InputError(path.string(), "is a calibration of OCamCalib (Scaramuzza), which is not supported",
                     "calibrate with Kalibr, by --models omni-radtan, ds-none or pinhole-equi");
  }
  const auto format = std::ranges::find_if(kFormats, [&](const Format& each) { return each.matches(fields); });
  if (format != kFormats.end()) return format->read(fields, path);
  if (auto list = nested_cameras(fields, fields, path)) return std::move(*list);
  throw InputError(
      path.string(), "is not a supported calibration file",
      "supported files have the field intrinsics (EuRoC sensor.yaml), camera_matrix or K (OpenCV, ROS), "
      "M1 or K1 (OpenCV stereo), cam0 (Kalibr camchain, OpenVINS), Camera.fx or Camera1.fx (ORB-SLAM), "
      "Camera (stella_vslam), model_type or cam0_calib (VINS), cameras (okvis, maplab), value0 (basalt), "
      "cameraData (DepthAI), P0 (KITTI), projection_type (OpenSfM), RadialDistortion (MATLAB), fc (Bouguet), "
      "calibration (Metashape), or fx, fy, cx, cy");
}

}  // namespace byre
