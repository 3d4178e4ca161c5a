#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"
#include "byre/io/calibration/format_readers.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Fields = CalibrationFields;

// ---- ORB-SLAM2, ORB-SLAM3

bool is_orb_slam_depth(const Fields& fields) {
  return fields.has("DepthMapFactor") || fields.has("RGBD.DepthMapFactor");
}

PlacedCamera orb_slam_camera(const Fields& fields, const std::string& prefix) {
  const std::string type = text_or(fields, "Camera.type", "PinHole");
  if (type != "PinHole" && type != "KannalaBrandt8" && type != "Rectified") {
    throw InputError(fields.place("Camera.type"), "\"" + type + "\" is not supported",
                     "supported types: PinHole, KannalaBrandt8, Rectified");
  }
  PlacedCamera result;
  Camera& camera = result.camera;
  const std::string owner = fields.has("Camera.width") ? "Camera" : "Image";  // Image: SSVO
  read_size(fields, owner + ".width", owner + ".height", camera);
  set_intrinsics(fields, {prefix + "fx", prefix + "fy", prefix + "cx", prefix + "cy"}, camera);
  if (type == "KannalaBrandt8") {
    set_opencv_distortion(camera, coefficients_of(fields, prefix, {"k1", "k2", "k3", "k4"}), true,
                          fields.place(prefix + "k1"));
  } else if (type == "PinHole") {
    set_opencv_distortion(camera, coefficients_of(fields, prefix, {"k1", "k2", "p1", "p2", "k3"}), false,
                          fields.place(prefix + "k1"));
  }
  return result;
}

// ORB-SLAM2 takes Camera.fx from LEFT.P. Fields of another camera are often left over from the example.
void require_own_rectification(const Fields& fields) {
  const double focal = fields.numbers("LEFT.P", 12)[0];
  const double camera_focal = fields.number_or("Camera.fx", focal);
  if (std::abs(focal - camera_focal) <= 1e-3 * focal) return;
  throw InputError(fields.place("LEFT.P"), "has another focal length than Camera.fx",
                   "delete the fields LEFT and RIGHT if the images are rectified, else correct Camera.fx");
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

}  // namespace

CameraList read_orb_slam(const Fields& fields, const fs::path&) {
  const bool is_third = fields.has("Camera1.fx") || fields.has("File.version");
  CameraList list{is_third ? "ORB-SLAM3" : "ORB-SLAM2", {}};
  const bool has_source = fields.has("LEFT.K") && fields.has("RIGHT.K");
  const bool is_placeholder = has_source && fields.has("LEFT.R") && fields.matrix("LEFT.R").isZero();
  if (is_placeholder) list.notes.push_back("LEFT.R is zero, so the fields LEFT and RIGHT are not used");
  if (has_source && !is_placeholder) {
    require_own_rectification(fields);
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
      list.cameras[1].from_previous = baseline_pose(-baseline);
      list.cameras[1].pose_place = fields.place(fields.has("Stereo.b") ? "Stereo.b" : "Camera.bf");
    }
  }
  for (const char* const field : {"IMU.T_b_c1", "T_b_c1", "Tbc"}) {
    if (fields.has(field)) list.cameras.front().body_from_camera = fields.pose(field);
  }
  return list;
}

CameraList read_stella(const Fields& file, const fs::path&) {
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
  list.cameras[1].from_previous = baseline_pose(-focal_baseline / whole.camera.fx);
  list.cameras[1].pose_place = fields.place(prefix + "focal_x_baseline");
  return list;
}

CameraList read_vins_camera(const Fields& fields, const fs::path&) {
  PlacedCamera camera = vins_camera(fields);
  camera.body_from_camera = vins_pose(fields, "body_T_cam0");
  camera.pose_place = fields.place("body_T_cam0");
  return {"VINS", {camera}};
}

CameraList read_vins_rig(const Fields& fields, const fs::path& path) {
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

CameraList read_camera_list(const Fields& file, const fs::path&) {
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

CameraList read_basalt(const Fields& file, const fs::path&) {
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

CameraList read_maplab_camera(const CalibrationFields& fields, const fs::path&) {
  return {"maplab", {maplab_camera(fields)}};
}

}  // namespace byre
