// Calibrations that devices and recordings come with.
#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"
#include "byre/io/calibration/format_readers.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Fields = CalibrationFields;

Pose pose_of(const Fields& fields, const std::string& rotation, const Eigen::Vector3d& translation) {
  const auto matrix = rotation_from_matrix(fields.matrix(rotation));
  if (!matrix) throw InputError(fields.place(rotation), "is not a rotation", "calibrate the device again");
  return {*matrix, translation};
}

// ---- DepthAI (OAK)

struct DepthaiCamera {
  PlacedCamera placed;
  std::optional<Pose> to_pose{};  // pose of this camera in the one at to_socket
  std::string to_socket{};
};

DepthaiCamera depthai_camera(const Fields& fields) {
  constexpr double kCentimetre = 0.01;
  constexpr int kFisheye = 1;
  DepthaiCamera result;
  Camera& camera = result.placed.camera;
  camera.width = fields.pixels("width");
  camera.height = fields.pixels("height");
  set_camera_matrix(camera, fields.numbers("intrinsicMatrix", 9), fields.place("intrinsicMatrix"));
  const bool is_fisheye = fields.number_or("cameraType", 0.0) == kFisheye;
  std::vector<double> coefficients = fields.numbers("distortionCoeff");
  if (is_fisheye && coefficients.size() > 4) coefficients.resize(4);
  set_opencv_distortion(camera, coefficients, is_fisheye, fields.place("distortionCoeff"));
  const Fields extrinsics = fields.group("extrinsics");
  result.placed.pose_place = fields.place("extrinsics");
  if (extrinsics.number("toCameraSocket") < 0.0 || !extrinsics.has_numbers("rotationMatrix", 9)) return result;
  const Fields translation = extrinsics.group("translation");
  result.to_socket = extrinsics.text("toCameraSocket");
  result.to_pose =
      pose_of(extrinsics, "rotationMatrix",
              kCentimetre * Eigen::Vector3d(translation.number("x"), translation.number("y"), translation.number("z")));
  return result;
}

// Pose of a camera in the last one of its chain of sockets, and the name of that socket.
std::pair<Pose, std::string> chain_of(const std::map<std::string, DepthaiCamera>& cameras, std::string socket) {
  Pose pose;
  for (std::size_t step = 0; step < cameras.size(); ++step) {
    const auto camera = cameras.find(socket);
    if (camera == cameras.end() || !camera->second.to_pose) break;
    pose = *camera->second.to_pose * pose;
    socket = camera->second.to_socket;
  }
  return {pose, socket};
}

// ---- ZED

struct ZedResolution {
  const char* name;
  int width;
  int height;
};

constexpr std::array kZedResolutions = {ZedResolution{"2K", 2208, 1242},      ZedResolution{"FHD", 1920, 1080},
                                        ZedResolution{"FHD1200", 1920, 1200}, ZedResolution{"HD", 1280, 720},
                                        ZedResolution{"SVGA", 960, 600},      ZedResolution{"VGA", 672, 376}};

PlacedCamera zed_camera(const Fields& fields, const ZedResolution& resolution) {
  PlacedCamera result{{.width = resolution.width, .height = resolution.height}};
  set_intrinsics(fields, {"fx", "fy", "cx", "cy"}, result.camera);
  set_opencv_distortion(result.camera, coefficients_of(fields, "", {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}),
                        false, fields.place("k1"));
  return result;
}

}  // namespace

CameraList read_depthai(const Fields& fields, const fs::path& path) {
  std::map<std::string, DepthaiCamera> cameras;
  for (const auto& [socket, group] : fields.groups("cameraData")) cameras[socket] = depthai_camera(group);
  std::string left = "1", right = "2";
  if (fields.is_group("stereoRectificationData")) {
    const Fields stereo = fields.group("stereoRectificationData");
    left = text_or(stereo, "leftCameraSocket", left);
    right = text_or(stereo, "rightCameraSocket", right);
  }
  CameraList list{"DepthAI", {}};
  if (cameras.contains(left) && cameras.contains(right)) {
    const auto [left_pose, left_end] = chain_of(cameras, left);
    const auto [right_pose, right_end] = chain_of(cameras, right);
    list.cameras = {cameras[left].placed, cameras[right].placed};
    if (left_end == right_end) list.cameras[1].from_previous = inverse(right_pose) * left_pose;
    if (cameras.size() > 2) {
      list.notes.push_back(fmt::format("sockets {} and {} are used of {}", left, right, cameras.size()));
    }
  } else if (cameras.size() == 1) {
    list.cameras = {cameras.begin()->second.placed};
  } else {
    throw InputError(path.string(), "has no pair of cameras", "calibrate the device as a stereo camera");
  }
  return list;
}

CameraList read_zed(const Fields& fields, std::optional<std::pair<int, int>> size) {
  constexpr double kMillimetre = 1e-3;
  std::vector<ZedResolution> found;
  for (const ZedResolution& each : kZedResolutions) {
    const std::string name = each.name;
    if (fields.is_group("LEFT_CAM_" + name) && fields.is_group("RIGHT_CAM_" + name)) found.push_back(each);
  }
  if (found.empty()) throw InputError(fields.place("LEFT_CAM_HD"), "is missing");
  const auto wanted = std::ranges::find_if(
      found, [&](const ZedResolution& each) { return !size || *size == std::pair(each.width, each.height); });
  if (wanted == found.end()) throw InputError(fields.place("LEFT_CAM_HD"), "is not of this image size");
  const std::string name = wanted->name;
  CameraList list{
      "ZED",
      {zed_camera(fields.group("LEFT_CAM_" + name), *wanted), zed_camera(fields.group("RIGHT_CAM_" + name), *wanted)}};
  const Fields stereo = fields.group("STEREO");
  // The translation is the position of the right camera, the rotation that of points from the left to the right camera.
  const Eigen::Vector3d rotation(stereo.number("RX_" + name), stereo.number("CV_" + name), stereo.number("RZ_" + name));
  const Eigen::Vector3d position(stereo.number("Baseline"), stereo.number("TY"), stereo.number("TZ"));
  list.cameras[1].from_previous = Pose{rotation_exp(rotation), -kMillimetre * position};
  list.cameras[1].pose_place = fields.place("STEREO");
  if (found.size() > 1 && !size) {
    std::string sizes;
    for (const ZedResolution& each : found) sizes += fmt::format(" {}x{}", each.width, each.height);
    list.notes.push_back("has cameras of" + sizes + "; --size selects one");
  }
  return list;
}

// ---- COLMAP, KITTI

namespace {

PlacedCamera colmap_camera(const Fields& row) {
  constexpr double kHalf = 0.5;  // COLMAP's principal points minus byre's, pixels
  const std::string model = row.text("model");
  std::vector<double> numbers = row.numbers("parameters");
  if (model.starts_with("SIMPLE") || model.starts_with("RADIAL")) numbers.insert(numbers.begin(), numbers.front());
  if (model.starts_with("THIN_PRISM") || numbers.size() < 4) {
    throw InputError(row.place("model"), "\"" + model + "\" is not supported, or has too few parameters",
                     "reconstruct with another camera model");
  }
  PlacedCamera result;
  Camera& camera = result.camera;
  camera.width = row.pixels("width"), camera.height = row.pixels("height");
  const std::vector<double> intrinsics = {numbers[0], numbers[1], numbers[2] - kHalf, numbers[3] - kHalf};
  std::vector<double> coefficients(numbers.begin() + 4, numbers.end());
  if (model == "FOV") {
    set_kalibr_lens(camera, {"pinhole", intrinsics, "fov", coefficients}, row.place("parameters"));
  } else {
    set_kalibr_lens(camera, {"pinhole", intrinsics, "none", {}}, row.place("parameters"));
    coefficients.resize(std::max<std::size_t>(coefficients.size(), 4), 0.0);
    set_opencv_distortion(camera, coefficients, model.ends_with("FISHEYE"), row.place("parameters"));
  }
  return result;
}

}  // namespace

CameraList read_colmap(const Fields& fields, const fs::path&) {
  CameraList list{"COLMAP cameras.txt", {}};
  for (const Fields& row : fields.list("colmap")) {
    list.cameras.push_back(colmap_camera(row));
    list.names.push_back(row.text("id"));
  }
  return list;
}

CameraList read_kitti(const Fields& fields, const fs::path&) {
  CameraList list{"KITTI", {}};
  for (const auto& [projection, size] :
       {std::pair("P0", "S0"), std::pair("P1", "S1"), std::pair("P_rect_00", "S_rect_00"),
        std::pair("P_rect_01", "S_rect_01"), std::pair("P2", "S2"), std::pair("P3", "S3")}) {
    const bool is_colour = std::string_view(projection) == "P2" || std::string_view(projection) == "P3";
    const bool is_other_pair = is_colour && (fields.has("P0") || fields.has("P_rect_00"));
    if (!fields.has(projection) || list.cameras.size() == 2 || is_other_pair) continue;
    PlacedCamera camera;
    if (fields.has(size)) {
      const std::vector<double> sides = fields.numbers(size, 2);
      camera.camera.width = to_image_side(sides[0], fields.place(size));
      camera.camera.height = to_image_side(sides[1], fields.place(size));
    }
    RectifiedView view;
    view.projection = Eigen::Map<const decltype(view.projection)>(fields.numbers(projection, 12).data());
    const auto& p = view.projection;
    set_camera_matrix(camera.camera, {p(0, 0), p(0, 1), p(0, 2), p(1, 0), p(1, 1), p(1, 2), 0.0, 0.0, p(2, 2)},
                      fields.place(projection));
    camera.rectified = view;
    camera.pose_place = fields.place(projection);
    list.cameras.push_back(camera);
  }
  list.notes.push_back("rectified images, as KITTI has them");
  return list;
}

}  // namespace byre
