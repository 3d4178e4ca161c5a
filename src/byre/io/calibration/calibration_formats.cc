#include "byre/io/calibration/calibration_formats.h"

#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Fields = CalibrationFields;

Pose shifted(double x, double y = 0.0) {
  return {Eigen::Quaterniond::Identity(), {x, y, 0.0}};
}

std::string text_or(const Fields& fields, const std::string& field, const std::string& otherwise) {
  return fields.has(field) ? fields.text(field) : otherwise;
}

bool has_all(const Fields& fields, std::initializer_list<const char*> names) {
  return std::ranges::all_of(names, [&](const char* name) { return fields.has(name); });
}

// Image size from two fields; unknown if the file has neither.
void read_size(const Fields& fields, const std::string& width, const std::string& height, Camera& camera) {
  if (!fields.has(width) && !fields.has(height)) return;
  camera.width = fields.pixels(width);
  camera.height = fields.pixels(height);
}

// Numbers of fields k1, k2 and the like; missing ones are zero.
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

// ---- Kalibr, OpenVINS

PlacedCamera kalibr_camera(const Fields& fields) {
  PlacedCamera result{read_camera_fields(fields, "distortion_coeffs")};
  if (fields.has("T_cam_imu")) result.body_from_camera = inverse(fields.pose("T_cam_imu"));
  if (fields.has("T_imu_cam")) result.body_from_camera = fields.pose("T_imu_cam");
  if (fields.has("T_cn_cnm1")) result.from_previous = fields.pose("T_cn_cnm1");
  result.readout_time = read_readout_time(fields, result.camera);
  result.pose_place = fields.place("T_cn_cnm1");
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

// ---- EuRoC

CameraList euroc_camera(const Fields& fields, const fs::path&) {
  PlacedCamera camera{read_camera_fields(fields, "distortion_coefficients")};
  if (fields.has("T_BS")) camera.body_from_camera = fields.pose("T_BS");
  camera.readout_time = read_readout_time(fields, camera.camera);
  camera.pose_place = fields.place("T_BS");
  return {"EuRoC sensor.yaml", {camera}};
}

// ---- ROS, OpenCV with one camera

std::optional<RectifiedView> rectified_view(const Fields& fields, const std::string& rotation,
                                            const std::string& projection) {
  if (!fields.has(rotation) || !fields.has(projection)) return std::nullopt;
  RectifiedView view{fields.matrix(rotation)};
  view.projection = Eigen::Map<const decltype(view.projection)>(fields.numbers(projection, 12).data());
  return view;
}

PlacedCamera opencv_camera(const Fields& fields) {
  PlacedCamera camera{read_opencv_camera(fields)};
  if (fields.has("T_BS")) camera.body_from_camera = fields.pose("T_BS");
  camera.rectified = rectified_view(fields, "rectification_matrix", "projection_matrix");
  camera.readout_time = read_readout_time(fields, camera.camera);
  camera.pose_place = fields.place("projection_matrix");
  return camera;
}

CameraList opencv_or_ros_camera(const Fields& fields, const fs::path&) {
  return {fields.has("projection_matrix") ? "ROS camera_info" : "OpenCV", {opencv_camera(fields)}};
}

CameraList ros_ini_pair(const Fields& fields, const fs::path&) {
  return {"ROS camera_info", {opencv_camera(fields.group("left")), opencv_camera(fields.group("right"))}};
}

// ---- OpenCV with other names

struct MatrixNames {
  const char* matrix;
  const char* distortion;
};

constexpr std::array kSingleNames = {MatrixNames{"K", "D"},
                                     MatrixNames{"k", "d"},
                                     MatrixNames{"cameraMatrix", "distCoeffs"},
                                     MatrixNames{"camera_matrix", "dist_coeffs"},
                                     MatrixNames{"camera_matrix", "dist_coeff"},
                                     MatrixNames{"camera_matrix", "distCoeffs"},
                                     MatrixNames{"Camera_Matrix", "Distortion_Coefficients"},
                                     MatrixNames{"intrinsic_matrix", "distortion_coefficients"},
                                     MatrixNames{"M", "D"},
                                     MatrixNames{"mtx", "dist"}};

constexpr std::array kPairNames = {
    std::pair(MatrixNames{"M1", "D1"}, MatrixNames{"M2", "D2"}),
    std::pair(MatrixNames{"K1", "D1"}, MatrixNames{"K2", "D2"}),
    std::pair(MatrixNames{"cameraMatrix1", "distCoeffs1"}, MatrixNames{"cameraMatrix2", "distCoeffs2"}),
    std::pair(MatrixNames{"cameraMatrixL", "distCoeffsL"}, MatrixNames{"cameraMatrixR", "distCoeffsR"}),
    std::pair(MatrixNames{"cameraMatrixL", "distCoeffL"}, MatrixNames{"cameraMatrixR", "distCoeffR"}),
    std::pair(MatrixNames{"camera_matrix_1", "dist_coeffs_1"}, MatrixNames{"camera_matrix_2", "dist_coeffs_2"}),
    std::pair(MatrixNames{"camera_matrix_left", "distortion_coefficients_left"},
              MatrixNames{"camera_matrix_right", "distortion_coefficients_right"}),
    std::pair(MatrixNames{"left_camera_matrix", "left_distortion_coefficients"},
              MatrixNames{"right_camera_matrix", "right_distortion_coefficients"}),
    std::pair(MatrixNames{"K_left", "D_left"}, MatrixNames{"K_right", "D_right"}),
    std::pair(MatrixNames{"left_K", "left_D"}, MatrixNames{"right_K", "right_D"}),
    std::pair(MatrixNames{"K_l", "D_l"}, MatrixNames{"K_r", "D_r"}),
    std::pair(MatrixNames{"KL", "DL"}, MatrixNames{"KR", "DR"}),
    std::pair(MatrixNames{"Kl", "Dl"}, MatrixNames{"Kr", "Dr"})};

bool has_camera(const Fields& fields, const MatrixNames& names) {
  return fields.has(names.matrix) && fields.has(names.distortion);
}

void read_any_size(const Fields& fields, Camera& camera) {
  for (const auto& [width, height] :
       {std::pair("image_width", "image_height"), std::pair("image_Width", "image_Height"),
        std::pair("width", "height"), std::pair("imageWidth", "imageHeight")}) {
    if (fields.has(width)) return read_size(fields, width, height, camera);
  }
  for (const char* const size : {"imageSize", "image_size", "size", "resolution", "img_size"}) {
    if (!fields.has(size)) continue;
    const std::vector<double> sides = fields.numbers(size, 2);
    camera.width = to_image_side(sides[0], fields.place(size));
    camera.height = to_image_side(sides[1], fields.place(size));
    return;
  }
}

bool is_fisheye(const Fields& fields) {
  for (const char* const field : {"distortion_model", "model", "distortion_type", "camera_model"}) {
    if (!fields.has(field)) continue;
    const std::string name = fields.text(field);
    if (name == "equidistant" || name == "fisheye" || name == "kannala_brandt") return true;
  }
  for (const char* const flag : {"fisheye_model", "fisheye", "is_fisheye"}) {
    if (!fields.has(flag)) continue;
    const std::string value = fields.text(flag);
    if (value == "1" || value == "true") return true;
  }
  return false;
}

Camera matrix_camera(const Fields& fields, const MatrixNames& names, std::vector<std::string>& notes) {
  constexpr std::size_t kAmbiguous = 4;
  Camera camera;
  read_any_size(fields, camera);
  set_camera_matrix(camera, fields.numbers(names.matrix, 9), fields.place(names.matrix));
  const std::vector<double> coefficients = fields.numbers(names.distortion);
  set_opencv_distortion(camera, coefficients, is_fisheye(fields), fields.place(names.distortion));
  if (coefficients.size() == kAmbiguous && camera.model == CameraModel::radial_tangential) {
    notes.push_back(
        std::string(names.distortion) +
        ": four coefficients are read as k1, k2, p1, p2; a fisheye needs \"distortion_model: equidistant\"");
  }
  return camera;
}

bool is_matrix_camera(const Fields& fields) {
  return std::ranges::any_of(kSingleNames, [&](const MatrixNames& names) { return has_camera(fields, names); });
}

CameraList matrix_cameras(const Fields& fields, const fs::path&) {
  const auto names =
      std::ranges::find_if(kSingleNames, [&](const MatrixNames& each) { return has_camera(fields, each); });
  const bool is_ros = fields.has("distortion_model") && (fields.has("P") || fields.has("p"));
  CameraList list{is_ros ? "ROS camera_info" : "OpenCV", {}};
  PlacedCamera camera{matrix_camera(fields, *names, list.notes)};
  if (fields.has("T_BS")) camera.body_from_camera = fields.pose("T_BS");
  camera.rectified = rectified_view(fields, "R", "P");
  if (!camera.rectified) camera.rectified = rectified_view(fields, "r", "p");
  camera.pose_place = fields.place("P");
  list.cameras.push_back(camera);
  return list;
}

bool is_matrix_pair(const Fields& fields) {
  return std::ranges::any_of(kPairNames, [&](const auto& names) {
    return has_camera(fields, names.first) && has_camera(fields, names.second);
  });
}

// Points from the first camera to the second: R, a matrix or a rotation vector, and T.
std::optional<Pose> extrinsics_of(const Fields& fields) {
  constexpr std::array kNames = {MatrixNames{"R", "T"}, MatrixNames{"R", "t"}, MatrixNames{"rotation", "translation"},
                                 MatrixNames{"rotation_matrix", "translation_vector"}, MatrixNames{"om", "T"}};
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

// The pose of a pair in a file beside the one of its intrinsics.
std::optional<Pose> extrinsics_beside(const fs::path& path) {
  for (const char* const name : {"extrinsics.yml", "extrinsics.yaml", "extrinsics.xml"}) {
    const fs::path file = path.parent_path() / name;
    if (fs::is_regular_file(file)) return read_opencv_extrinsics(file);
  }
  return std::nullopt;
}

CameraList matrix_pair(const Fields& fields, const fs::path& path) {
  const auto names = std::ranges::find_if(
      kPairNames, [&](const auto& each) { return has_camera(fields, each.first) && has_camera(fields, each.second); });
  CameraList list{"OpenCV stereo", {}};
  list.cameras = {{matrix_camera(fields, names->first, list.notes)},
                  {matrix_camera(fields, names->second, list.notes)}};
  list.cameras[1].from_previous = extrinsics_of(fields);
  if (!list.cameras[1].from_previous) list.cameras[1].from_previous = extrinsics_beside(path);
  list.cameras[1].pose_place = fields.place("R, T");
  return list;
}

// ---- ORB-SLAM2, ORB-SLAM3

bool is_orb_slam_depth(const Fields& fields) {
  return fields.has("DepthMapFactor") || fields.has("RGBD.DepthMapFactor");
}

PlacedCamera orb_slam_camera(const Fields& fields, const std::string& prefix) {
  const std::string type = text_or(fields, "Camera.type", "PinHole");
  PlacedCamera result;
  Camera& camera = result.camera;
  read_size(fields, "Camera.width", "Camera.height", camera);
  set_intrinsics(fields, {prefix + "fx", prefix + "fy", prefix + "cx", prefix + "cy"}, camera);
  if (type == "KannalaBrandt8") {
    set_opencv_distortion(camera, coefficients_of(fields, prefix, {"k1", "k2", "k3", "k4"}), true,
                          fields.place(prefix + "k1"));
  } else if (type == "PinHole") {
    set_opencv_distortion(camera, coefficients_of(fields, prefix, {"k1", "k2", "p1", "p2", "k3"}), false,
                          fields.place(prefix + "k1"));
  } else if (type != "Rectified") {
    throw InputError(fields.place("Camera.type"), "\"" + type + "\" is not supported",
                     "supported types: PinHole, KannalaBrandt8, Rectified");
  }
  return result;
}

// Cameras of ORB-SLAM2's own rectification.
PlacedCamera orb_slam_rectified_camera(const Fields& fields, const std::string& side) {
  PlacedCamera result;
  read_size(fields, side + ".width", side + ".height", result.camera);
  set_camera_matrix(result.camera, fields.numbers(side + ".K", 9), fields.place(side + ".K"));
  set_opencv_distortion(result.camera, fields.numbers(side + ".D"), false, fields.place(side + ".D"));
  result.rectified = rectified_view(fields, side + ".R", side + ".P");
  result.pose_place = fields.place(side + ".P");
  return result;
}

CameraList orb_slam_cameras(const Fields& fields, const fs::path&) {
  const bool is_third = fields.has("Camera1.fx") || fields.has("File.version");
  CameraList list{is_third ? "ORB-SLAM3" : "ORB-SLAM2", {}};
  if (fields.has("LEFT.K") && fields.has("RIGHT.K")) {
    list.cameras = {orb_slam_rectified_camera(fields, "LEFT"), orb_slam_rectified_camera(fields, "RIGHT")};
  } else {
    list.cameras = {orb_slam_camera(fields, fields.has("Camera1.fx") ? "Camera1." : "Camera.")};
    const PlacedCamera& left = list.cameras.front();
    const double focal_baseline = fields.number_or("Camera.bf", 0.0);
    const double baseline = fields.number_or("Stereo.b", focal_baseline / left.camera.fx);
    if (fields.has("Camera2.fx")) {
      list.cameras.push_back(orb_slam_camera(fields, "Camera2."));
      for (const char* const field : {"Stereo.T_c1_c2", "Tlr"}) {
        if (fields.has(field)) list.cameras[1].from_previous = inverse(fields.pose(field));
      }
      list.cameras[1].pose_place = fields.place("Stereo.T_c1_c2");
    } else if (baseline > 0.0 && !is_orb_slam_depth(fields)) {
      list.cameras.push_back(left);
      list.cameras[1].from_previous = shifted(-baseline);
      list.cameras[1].pose_place = fields.place(fields.has("Stereo.b") ? "Stereo.b" : "Camera.bf");
    }
  }
  for (const char* const field : {"IMU.T_b_c1", "Tbc"}) {
    if (fields.has(field)) list.cameras.front().body_from_camera = fields.pose(field);
  }
  return list;
}

// ---- stella_vslam, OpenVSLAM

PlacedCamera stella_camera(const Fields& fields, const std::string& prefix) {
  const std::string model = text_or(fields, prefix + "model", "perspective");
  PlacedCamera result;
  read_size(fields, prefix + "cols", prefix + "rows", result.camera);
  set_intrinsics(fields, {prefix + "fx", prefix + "fy", prefix + "cx", prefix + "cy"}, result.camera);
  const bool is_fisheye = model == "fisheye";
  const std::vector<double> coefficients = is_fisheye ? coefficients_of(fields, prefix, {"k1", "k2", "k3", "k4"})
                                                      : coefficients_of(fields, prefix, {"k1", "k2", "p1", "p2", "k3"});
  set_opencv_distortion(result.camera, coefficients, is_fisheye, fields.place(prefix + "k1"));
  return result;
}

// One camera before stella's own rectification.
PlacedCamera stella_source_camera(const Fields& fields, const std::string& prefix, const std::string& side,
                                  const Camera& size, double shift, double focal) {
  PlacedCamera result{{.width = size.width, .height = size.height}};
  const bool is_fisheye = text_or(fields, prefix + "model", "perspective") == "fisheye";
  set_camera_matrix(result.camera, fields.numbers(prefix + "K_" + side, 9), fields.place(prefix + "K_" + side));
  set_opencv_distortion(result.camera, fields.numbers(prefix + "D_" + side), is_fisheye,
                        fields.place(prefix + "D_" + side));
  result.rectified = RectifiedView{fields.matrix(prefix + "R_" + side)};
  result.rectified->projection(0, 0) = result.rectified->projection(1, 1) = focal;
  result.rectified->projection(0, 3) = shift;
  result.pose_place = fields.place(prefix + "R_" + side);
  return result;
}

CameraList stella_cameras(const Fields& file, const fs::path&) {
  const bool is_nested = file.has("Camera");
  const Fields fields = is_nested ? file.group("Camera") : file;
  const std::string prefix = is_nested ? "" : "Camera.";
  const std::string model = text_or(fields, prefix + "model", "perspective");
  if (model != "perspective" && model != "fisheye") {
    throw InputError(fields.place(prefix + "model"), "\"" + model + "\" is not supported",
                     "supported models: perspective, fisheye");
  }
  CameraList list{"stella_vslam", {stella_camera(fields, prefix)}};
  const PlacedCamera whole = list.cameras.front();
  if (text_or(fields, prefix + "setup", "") != "stereo") return list;
  const double focal_baseline = fields.number(prefix + "focal_x_baseline");
  const bool has_source = is_nested ? file.has("StereoRectifier") : file.has("StereoRectifier.K_left");
  if (has_source) {
    const Fields source = is_nested ? file.group("StereoRectifier") : file;
    const std::string source_prefix = is_nested ? "" : "StereoRectifier.";
    const Camera size = whole.camera;
    list.cameras = {stella_source_camera(source, source_prefix, "left", size, 0.0, size.fx),
                    stella_source_camera(source, source_prefix, "right", size, -focal_baseline, size.fx)};
    return list;
  }
  list.cameras.push_back(whole);
  list.cameras[1].from_previous = shifted(-focal_baseline / whole.camera.fx);
  list.cameras[1].pose_place = fields.place(prefix + "focal_x_baseline");
  return list;
}

// ---- VINS-Fusion, VINS-Mono (camodocal)

PlacedCamera vins_camera(const Fields& fields) {
  PlacedCamera result;
  Camera& camera = result.camera;
  const std::string type = fields.text("model_type");
  read_size(fields, "image_width", "image_height", camera);
  const auto lens = [&] { return fields.group("distortion_parameters"); };
  const Fields projection = fields.group("projection_parameters");
  const std::string place = fields.place("projection_parameters");
  if (type == "PINHOLE") {
    set_intrinsics(projection, {"fx", "fy", "cx", "cy"}, camera);
    set_opencv_distortion(camera, coefficients_of(lens(), "", {"k1", "k2", "p1", "p2"}), false, place);
  } else if (type == "PINHOLE_FULL") {
    set_intrinsics(projection, {"fx", "fy", "cx", "cy"}, camera);
    set_opencv_distortion(camera, coefficients_of(lens(), "", {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}), false,
                          place);
  } else if (type == "KANNALA_BRANDT") {
    set_intrinsics(projection, {"mu", "mv", "u0", "v0"}, camera);
    set_opencv_distortion(camera, coefficients_of(projection, "", {"k2", "k3", "k4", "k5"}), true, place);
  } else if (type == "MEI") {
    set_kalibr_lens(camera,
                    {"omni",
                     {fields.group("mirror_parameters").number("xi"), projection.number("gamma1"),
                      projection.number("gamma2"), projection.number("u0"), projection.number("v0")},
                     "radtan",
                     coefficients_of(lens(), "", {"k1", "k2", "p1", "p2"})},
                    place);
  } else {
    throw InputError(fields.place("model_type"), "\"" + type + "\" is not supported",
                     "supported types: PINHOLE, PINHOLE_FULL, KANNALA_BRANDT, MEI");
  }
  return result;
}

std::optional<Pose> vins_pose(const Fields& fields, const std::string& field) {
  if (fields.has(field)) return fields.pose(field);
  if (field != "body_T_cam0" || !has_all(fields, {"extrinsicRotation", "extrinsicTranslation"})) return std::nullopt;
  const auto rotation = rotation_from_matrix(fields.matrix("extrinsicRotation"));
  if (!rotation) throw InputError(fields.place("extrinsicRotation"), "is not a rotation");
  return Pose{*rotation, Eigen::Vector3d(fields.numbers("extrinsicTranslation", 3).data())};
}

CameraList vins_single(const Fields& fields, const fs::path&) {
  PlacedCamera camera = vins_camera(fields);
  camera.body_from_camera = vins_pose(fields, "body_T_cam0");
  camera.pose_place = fields.place("body_T_cam0");
  return {"VINS", {camera}};
}

CameraList vins_rig(const Fields& fields, const fs::path& path) {
  CameraList list{"VINS-Fusion", {}};
  for (const std::string name : {"cam0", "cam1"}) {
    if (!fields.has(name + "_calib")) continue;
    const fs::path file = path.parent_path() / fields.text(name + "_calib");
    list.cameras.push_back(vins_camera(Fields::load(file)));
    list.cameras.back().body_from_camera = vins_pose(fields, "body_T_" + name);
    list.cameras.back().pose_place = fields.place("body_T_" + name);
  }
  return list;
}

// ---- okvis, maplab

PlacedCamera okvis_camera(const Fields& fields) {
  PlacedCamera result;
  const std::vector<double> size = fields.numbers("image_dimension", 2);
  result.camera.width = to_image_side(size[0], fields.place("image_dimension"));
  result.camera.height = to_image_side(size[1], fields.place("image_dimension"));
  std::vector<double> intrinsics = fields.numbers("focal_length", 2);
  const std::vector<double> centre = fields.numbers("principal_point", 2);
  intrinsics.insert(intrinsics.end(), centre.begin(), centre.end());
  const std::string type = text_or(fields, "distortion_type", "radialtangential");
  set_kalibr_lens(result.camera, {"pinhole", intrinsics, type, fields.numbers("distortion_coefficients")},
                  fields.place("distortion_coefficients"));
  result.body_from_camera = fields.pose("T_SC");
  result.pose_place = fields.place("T_SC");
  return result;
}

PlacedCamera maplab_camera(const Fields& entry) {
  const Fields fields = entry.has("camera") ? entry.group("camera") : entry;
  PlacedCamera result;
  Camera& camera = result.camera;
  camera.width = fields.pixels("image_width");
  camera.height = fields.pixels("image_height");
  const std::string type = text_or(fields, "type", "pinhole");
  const std::string projection = type == "unified-projection" ? "omni" : type;
  std::string distortion = "none";
  std::vector<double> coefficients;
  if (fields.has("distortion")) {
    const Fields lens = fields.group("distortion");
    distortion = text_or(lens, "type", "none");
    if (distortion == "fisheye") distortion = "fov";  // aslam's name
    if (distortion != "none") coefficients = lens.numbers("parameters");
  }
  set_kalibr_lens(camera, {projection, fields.numbers("intrinsics"), distortion, coefficients},
                  fields.place("intrinsics"));
  if (entry.has("T_B_C")) result.body_from_camera = entry.pose("T_B_C");
  if (fields.has("line-delay-nanoseconds")) {
    result.readout_time = 1e-9 * fields.number("line-delay-nanoseconds") * camera.height;
  }
  result.pose_place = entry.place("T_B_C");
  return result;
}

CameraList listed_cameras(const Fields& file, const fs::path&) {
  const Fields fields = file.has("ncameras") ? file.list("ncameras").at(0) : file;
  const std::vector<Fields> entries = fields.list("cameras");
  if (entries.empty()) throw InputError(fields.place("cameras"), "is empty");
  const bool is_okvis = entries.front().has("focal_length");
  CameraList list{is_okvis ? "okvis" : "maplab", {}};
  for (std::size_t i = 0; i < std::min<std::size_t>(entries.size(), 2); ++i) {
    list.cameras.push_back(is_okvis ? okvis_camera(entries[i]) : maplab_camera(entries[i]));
  }
  if (entries.size() > 2) list.notes.push_back("cameras after the second are not used");
  return list;
}

// ---- basalt

Camera basalt_camera(const Fields& entry) {
  const std::string type = entry.text("camera_type");
  const Fields lens = entry.group("intrinsics");
  const auto values = [&](std::initializer_list<const char*> names) {
    std::vector<double> numbers;
    for (const char* const name : names) numbers.push_back(lens.number(name));
    return numbers;
  };
  Camera camera;
  const std::string place = entry.place("intrinsics");
  if (type == "pinhole") {
    set_kalibr_lens(camera, {"pinhole", values({"fx", "fy", "cx", "cy"}), "none", {}}, place);
  } else if (type == "kb4") {
    set_kalibr_lens(
        camera, {"pinhole", values({"fx", "fy", "cx", "cy"}), "equidistant", values({"k1", "k2", "k3", "k4"})}, place);
  } else if (type == "ds") {
    set_kalibr_lens(camera, {"ds", values({"xi", "alpha", "fx", "fy", "cx", "cy"}), "none", {}}, place);
  } else if (type == "eucm") {
    set_kalibr_lens(camera, {"eucm", values({"alpha", "beta", "fx", "fy", "cx", "cy"}), "none", {}}, place);
  } else if (type == "fov") {
    set_kalibr_lens(camera, {"pinhole", values({"fx", "fy", "cx", "cy"}), "fov", values({"w"})}, place);
  } else if (type == "pinhole-radtan8") {
    set_kalibr_lens(camera,
                    {"pinhole", values({"fx", "fy", "cx", "cy"}), "rational",
                     values({"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"})},
                    place);
  } else {
    throw InputError(entry.place("camera_type"), "\"" + type + "\" is not supported",
                     "supported types: pinhole, kb4, ds, eucm, fov, pinhole-radtan8");
  }
  return camera;
}

CameraList basalt_cameras(const Fields& file, const fs::path&) {
  const Fields fields = file.group("value0");
  const std::vector<Fields> lenses = fields.list("intrinsics");
  const std::vector<Fields> poses = fields.list("T_imu_cam");
  const std::vector<double> sizes = fields.numbers("resolution");
  if (lenses.empty() || poses.size() != lenses.size() || sizes.size() != 2 * lenses.size()) {
    throw InputError(fields.place("intrinsics"), "does not have one pose and resolution for each camera");
  }
  CameraList list{"basalt", {}};
  for (std::size_t i = 0; i < std::min<std::size_t>(lenses.size(), 2); ++i) {
    PlacedCamera camera{basalt_camera(lenses[i])};
    camera.camera.width = to_image_side(sizes[2 * i], fields.place("resolution"));
    camera.camera.height = to_image_side(sizes[2 * i + 1], fields.place("resolution"));
    require_valid(camera.camera, fields.place("intrinsics"));
    const auto at = [&](const char* name) { return poses[i].number(name); };
    const Eigen::Quaterniond rotation(at("qw"), at("qx"), at("qy"), at("qz"));
    if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) throw InputError(poses[i].place("qw"), "is not a unit quaternion");
    camera.body_from_camera = Pose{rotation.normalized(), {at("px"), at("py"), at("pz")}};
    list.cameras.push_back(camera);
  }
  if (lenses.size() > 2) list.notes.push_back("cameras after the second are not used");
  return list;
}

// ---- The formats, by their content

struct Format {
  bool (*matches)(const Fields&);
  CameraList (*read)(const Fields&, const fs::path&);
};

constexpr std::array kFormats = {
    Format{[](const Fields& f) { return f.has("cam0"); }, kalibr_cameras},
    Format{[](const Fields& f) { return f.has("relative_config_imucam"); }, openvins_config},
    Format{[](const Fields& f) { return f.has("value0"); }, basalt_cameras},
    Format{[](const Fields& f) { return f.has("cam0_calib"); }, vins_rig},
    Format{[](const Fields& f) { return f.has("model_type"); }, vins_single},
    Format{[](const Fields& f) { return f.has("cameras") || f.has("ncameras"); }, listed_cameras},
    Format{[](const Fields& f) { return f.has("Camera") || f.has("Camera.setup") || f.has("Camera.model"); },
           stella_cameras},
    Format{[](const Fields& f) { return f.has("Camera.fx") || f.has("Camera1.fx") || f.has("LEFT.K"); },
           orb_slam_cameras},
    Format{[](const Fields& f) { return is_matrix_pair(f); }, matrix_pair},
    Format{[](const Fields& f) { return f.has("camera_matrix") && !is_matrix_camera(f); }, opencv_or_ros_camera},
    Format{[](const Fields& f) { return is_matrix_camera(f); }, matrix_cameras},
    Format{[](const Fields& f) { return f.has("left") && f.has("right"); }, ros_ini_pair},
    Format{[](const Fields& f) { return f.has("intrinsics"); }, euroc_camera},
    Format{[](const Fields& f) { return f.has("image_width") && f.has("image_height") && f.has("type"); },
           [](const Fields& f, const fs::path&) {
             return CameraList{"maplab", {maplab_camera(f)}};
           }},
};

}  // namespace

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
  return inverse(rectified_from_right) * shifted(between.x(), between.y()) * rectified_from_left;
}

std::optional<Pose> read_opencv_extrinsics(const fs::path& path) {
  return extrinsics_of(CalibrationFields::load(path));
}

CameraList read_cameras(const fs::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  const auto format = std::ranges::find_if(kFormats, [&](const Format& each) { return each.matches(fields); });
  if (format != kFormats.end()) return format->read(fields, path);
  throw InputError(path.string(), "is not a supported calibration file",
                   "supported files have the field intrinsics (EuRoC sensor.yaml), camera_matrix or K (OpenCV, ROS), "
                   "M1 or K1 (OpenCV stereo), cam0 (Kalibr camchain, OpenVINS), Camera.fx or Camera1.fx (ORB-SLAM), "
                   "Camera (stella_vslam), model_type or cam0_calib (VINS), cameras (okvis, maplab), value0 (basalt)");
}

}  // namespace byre
