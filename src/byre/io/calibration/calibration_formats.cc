#include "byre/io/calibration/calibration_formats.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"
#include "byre/io/calibration/format_readers.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <system_error>

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

// Name of a field with those of the groups around it.
std::string full_name(const Fields& fields, const std::string& name, const fs::path& path) {
  return fields.place(name).substr(path.string().size() + 2);
}

CameraList kalibr_cameras(const Fields& fields, const fs::path& path) {
  CameraList list{fields.has("cam0") && fields.group("cam0").has("T_imu_cam") ? "OpenVINS" : "Kalibr camchain",
                  {kalibr_camera(fields.group("cam0"))}};
  if (fields.has("cam1")) list.cameras.push_back(kalibr_camera(fields.group("cam1")));
  for (int i = 0; fields.has(fmt::format("cam{}", i)); ++i) {
    list.names.push_back(full_name(fields, fmt::format("cam{}", i), path));
  }
  if (fields.has("cam2")) list.notes.push_back("cameras after cam1 are not used");
  return list;
}

CameraList openvins_config(const Fields& fields, const fs::path& path) {
  CameraList list = read_cameras(path.parent_path() / fields.text("relative_config_imucam"));
  list.format = "OpenVINS";
  list.names.clear();  // fields of the other file
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

// Whether a name has one of these words, between other signs than letters.
bool has_word(std::string_view name, std::initializer_list<std::string_view> words) {
  const std::string lower = lower_case(name);
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
  const std::string lower = lower_case(name);
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
  const bool is_of_one = first.starts_with("frames") || first.starts_with(kDocuments);
  if (!is_repeated || (found.size() == 2 && !is_of_one)) return;
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

// All cameras, with the names of their fields.
CameraList unplaced_cameras(const FoundCameras& found, const std::vector<std::string>& names) {
  CameraList all{found.front().second.format, {}};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const CameraList& list = found[i].second;
    all.cameras.insert(all.cameras.end(), list.cameras.begin(), list.cameras.end());
    if (list.cameras.size() > 2) {
      all.names.insert(all.names.end(), list.names.begin(), list.names.end());
    } else {
      all.names.push_back(names[i]);
    }
  }
  return all;
}

std::optional<CameraList> nested_cameras(const Fields& own, const Fields& fields, const fs::path& path);

// Cameras of a group. own: without the fields of the groups around it.
std::optional<CameraList> cameras_of_group(const Fields& own, const Fields& group, const fs::path& path) {
  const auto format =
      std::ranges::find_if(kFormats, [&](const Format& each) { return each.is_nested && each.matches(own); });
  return format != kFormats.end() ? format->read(group, path) : nested_cameras(own, group, path);
}

// Cameras inside other fields: the only camera or pair, the left and right of two, or all that have no relative poses.
// Empty if there is none. own: fields without those of the groups around them.
std::optional<CameraList> nested_cameras(const Fields& own, const Fields& fields, const fs::path& path) {
  FoundCameras found;
  for (const auto& [name, inner] : own.inner()) {
    const Fields group = inner.completed(fields, is_shared_field);
    if (auto list = cameras_of_group(inner, group, path)) found.emplace_back(name, std::move(*list));
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
  const FoundCameras all = found;
  std::vector<std::string> names;
  for (const auto& each : all) names.push_back(full_name(own, each.first, path));
  if (found.size() > 2 && !found.front().first.ends_with(']'))
    std::erase_if(found, [](const auto& each) { return !side_of(each.first); });
  const bool is_pair = found.size() == 2 && found[0].second.cameras.size() == 1 && found[1].second.cameras.size() == 1;
  if (!is_pair) return unplaced_cameras(all, names);
  if (side_of(found[0].first).value_or(0) > side_of(found[1].first).value_or(1)) std::swap(found[0], found[1]);
  CameraList list = std::move(found[0].second);
  list.names = {full_name(own, found[0].first, path), full_name(own, found[1].first, path)};
  list.cameras.push_back(found[1].second.cameras.front());
  list.notes.insert(list.notes.end(), found[1].second.notes.begin(), found[1].second.notes.end());
  if (!list.cameras[1].from_previous) place_pair(fields, list.cameras[0], list.cameras[1]);
  const PlacedCamera &left = list.cameras[0], &right = list.cameras[1];
  const bool is_placed =
      right.from_previous || (left.rectified && right.rectified) || (left.body_from_camera && right.body_from_camera);
  if (names.size() > 2 && !is_placed) return unplaced_cameras(all, names);
  if (list.cameras[1].pose_place.empty()) list.cameras[1].pose_place = fields.place("R, T");
  if (names.size() > 2)
    list.notes.push_back(fmt::format("of {} cameras, a left and a right one are used", names.size()));
  return list;
}

// The group of this name, also inside other groups, and the same with the fields that it shares with them.
std::optional<std::pair<Fields, Fields>> group_named(const Fields& own, const Fields& fields, std::string_view wanted) {
  for (const auto& [name, inner] : own.inner()) {
    const Fields group = inner.completed(fields, is_shared_field);
    if (name == wanted) return std::pair(inner, group);
    if (!wanted.starts_with(name + ".")) continue;
    if (auto found = group_named(inner, group, wanted.substr(name.size() + 1))) return found;
  }
  return std::nullopt;
}

// Whether a group has a rotation and translation, valid or not.
bool has_own_pose(const Fields& fields) {
  try {
    return pair_pose(fields).has_value();
  } catch (const InputError&) {
    return true;
  }
}

std::optional<CameraList> camera_of_group(const Fields& fields, const std::string& name, const fs::path& path) {
  const auto found = group_named(fields, fields, name);
  if (!found) return std::nullopt;
  auto list = cameras_of_group(found->first, found->second, path);
  if (!list || list->cameras.size() != 1) return list;
  const PlacedCamera& camera = list->cameras.front();
  if (!camera.body_from_camera && (camera.from_previous || has_own_pose(found->first))) {
    list->notes.push_back("the pose of " + name + " is not used: it is not a pose in a body (T_BS, T_cam_imu)");
  }
  return list;
}

void refuse_known_model(const Fields& fields) {
  for (const std::string& name : fields.names()) {
    if (!fields.has_scalar(name) || fields.text(name) != "FishPoly") continue;
    throw InputError(fields.place(name), "\"FishPoly\" is not supported",
                     "calibrate with Kalibr, by --models pinhole-equi, omni-radtan or ds-none");
  }
  for (const auto& [name, inner] : fields.inner()) refuse_known_model(inner);
}

CameraList cameras_of_file(const Fields& fields, const fs::path& path, std::optional<std::pair<int, int>> size) {
  if (fields.has("STEREO") && fields.is_group("STEREO")) return read_zed(fields, size);
  if (fields.has("colmap")) return read_colmap(fields, path);
  if (fields.has("ocam")) {
    throw InputError(path.string(), "is a calibration of OCamCalib (Scaramuzza), which is not supported",
                     "calibrate with Kalibr, by --models omni-radtan, ds-none or pinhole-equi");
  }
  const auto format = std::ranges::find_if(kFormats, [&](const Format& each) { return each.matches(fields); });
  if (format != kFormats.end()) return format->read(fields, path);
  const Fields grouped = with_affix_groups(fields);
  if (auto list = nested_cameras(grouped, grouped, path)) return std::move(*list);
  refuse_known_model(fields);
  throw InputError(
      path.string(), "is not a supported calibration file",
      "supported files have the field intrinsics (EuRoC sensor.yaml), camera_matrix or K (OpenCV, ROS), "
      "M1 or K1 (OpenCV stereo), cam0 (Kalibr camchain, OpenVINS), Camera.fx or Camera1.fx (ORB-SLAM), "
      "Camera (stella_vslam), model_type or cam0_calib (VINS), cameras (okvis, maplab), value0 (basalt), "
      "cameraData (DepthAI), P0 (KITTI), projection_type (OpenSfM), RadialDistortion (MATLAB), fc (Bouguet), "
      "calibration (Metashape), or fx, fy, cx, cy");
}

// Pose of the right camera in the body of the left one; empty if the file has none.
std::optional<Pose> body_from_right(const PlacedCamera& left, const PlacedCamera& right) {
  std::optional<Pose> pose = right.from_previous;
  if (!pose && left.rectified && right.rectified) pose = right_from_left(*left.rectified, *right.rectified);
  if (right.body_from_camera || !pose || !left.body_from_camera) return right.body_from_camera;
  return *left.body_from_camera * inverse(*pose);
}

// One camera of a list. Throws InputError for an unknown name.
CameraList camera_of_list(CameraList list, const std::string& name, const fs::path& path) {
  std::vector<std::string> names = list.names;
  if (names.empty() && list.cameras.size() == 2) names = {"left", "right"};
  auto found = std::ranges::find(names, name);
  if (list.cameras.size() == 2 && (name == "left" || name == "right"))
    found = names.begin() + (name == "right" ? 1 : 0);
  const auto index = static_cast<std::size_t>(found - names.begin());
  if (index >= std::min(list.cameras.size(), names.size())) {
    throw InputError(path.string(), fmt::format("has no camera \"{}\"", name),
                     names.empty() ? "it has one camera: give the file without a name"
                                   : fmt::format("cameras: {}", fmt::join(names, ", ")));
  }
  if (index == 1) list.cameras[1].body_from_camera = body_from_right(list.cameras[0], list.cameras[1]);
  PlacedCamera chosen = list.cameras[index];
  chosen.rectified.reset();
  if (*found != name) list.notes.push_back("the " + name + " camera is " + *found);
  return {list.format, {chosen}, list.notes};
}

// File of "FILE#NAME", and the name of the camera.
std::pair<fs::path, std::optional<std::string>> split_camera(const fs::path& path) {
  const std::string text = path.string();
  std::error_code error;  // ignored: cyclic links and the like have no camera
  if (fs::exists(path, error)) return {path, std::nullopt};
  for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at + 1)) {
    if (fs::is_regular_file(text.substr(0, at), error)) return {text.substr(0, at), text.substr(at + 1)};
  }
  return {path, std::nullopt};
}

}  // namespace

fs::path file_of_camera(const fs::path& path) {
  return split_camera(path).first;
}

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
  return pair_pose(CalibrationFields::load(file_of_camera(path)));
}

CameraList read_cameras(const fs::path& path, std::optional<std::pair<int, int>> size) {
  const auto [file, name] = split_camera(path);
  CalibrationFields fields = CalibrationFields::load(file);
  if (size) fields.set_size_of_images(size->first, size->second);
  CameraList list = [&] {
    if (!name) return cameras_of_file(fields, file, size);
    if (auto camera = camera_of_group(fields, *name, file)) return std::move(*camera);
    if (auto camera = camera_of_group(with_affix_groups(fields), *name, file)) return std::move(*camera);
    return camera_of_list(cameras_of_file(fields, file, size), *name, file);
  }();
  if (!fields.note().empty()) list.notes.push_back(fields.note());
  return list;
}

}  // namespace byre
