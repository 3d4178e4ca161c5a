#include "byre/io/colmap/colmap_camera.h"

#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"

#include <algorithm>
#include <array>
#include <utility>

namespace byre {
namespace {

constexpr std::array<ColmapCameraModel, 11> kKinds = {{{0, "SIMPLE_PINHOLE", 3},
                                                       {1, "PINHOLE", 4},
                                                       {2, "SIMPLE_RADIAL", 4},
                                                       {3, "RADIAL", 5},
                                                       {4, "OPENCV", 8},
                                                       {5, "OPENCV_FISHEYE", 8},
                                                       {6, "FULL_OPENCV", 12},
                                                       {7, "FOV", 5},
                                                       {8, "SIMPLE_RADIAL_FISHEYE", 4},
                                                       {9, "RADIAL_FISHEYE", 5},
                                                       {10, "THIN_PRISM_FISHEYE", 12}}};

constexpr double kHalf = 0.5;  // COLMAP's principal points minus byre's, pixels

Camera with_intrinsics(CameraModel model, double fx, double fy, double cx, double cy) {
  Camera camera;
  camera.model = model;
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx - kHalf;
  camera.cy = cy - kHalf;
  return camera;
}

// Parameters: f, cx, cy, and distortion.
Camera with_one_focal_length(const std::vector<double>& p, CameraModel model) {
  Camera camera = with_intrinsics(model, p[0], p[0], p[1], p[2]);
  std::copy(p.begin() + 3, p.end(), camera.distortion.begin());
  return camera;
}

// Parameters: fx, fy, cx, cy, and distortion.
Camera with_two_focal_lengths(const std::vector<double>& p, CameraModel model) {
  Camera camera = with_intrinsics(model, p[0], p[1], p[2], p[3]);
  std::copy_n(p.begin() + 4, std::min(p.size() - 4, camera.distortion.size()), camera.distortion.begin());
  return camera;
}

Camera lens_of(const ColmapCamera& camera, const std::string& place) {
  const std::vector<double>& p = camera.parameters;
  if (camera.model == "SIMPLE_PINHOLE") return with_one_focal_length(p, CameraModel::pinhole);
  if (camera.model == "PINHOLE") return with_two_focal_lengths(p, CameraModel::pinhole);
  if (camera.model == "SIMPLE_RADIAL" || camera.model == "RADIAL") {
    return with_one_focal_length(p, CameraModel::radial_tangential);
  }
  if (camera.model == "OPENCV") return with_two_focal_lengths(p, CameraModel::radial_tangential);
  if (camera.model == "OPENCV_FISHEYE") return with_two_focal_lengths(p, CameraModel::equidistant);
  if (camera.model == "FULL_OPENCV") {
    const bool is_polynomial = std::all_of(p.begin() + 9, p.end(), [](double k) { return k == 0.0; });
    return with_two_focal_lengths(p, is_polynomial ? CameraModel::radial_tangential : CameraModel::rational);
  }
  if (camera.model == "FOV") {
    Camera result = with_two_focal_lengths(p, CameraModel::field_of_view);
    std::swap(result.distortion[0], result.distortion[4]);
    return result;
  }
  if (camera.model == "SIMPLE_RADIAL_FISHEYE" || camera.model == "RADIAL_FISHEYE") {
    return with_one_focal_length(p, CameraModel::equidistant);
  }
  if (camera.model == "THIN_PRISM_FISHEYE") return with_two_focal_lengths(p, CameraModel::thin_prism_fisheye);
  throw InputError(place, "camera model " + camera.model + " is not supported",
                   "reconstruct with another camera model, or undistort the images with \"colmap image_undistorter\"");
}

[[noreturn]] void refuse_export(CameraModel model) {
  throw InputError("calibration", "COLMAP has no camera model for " + std::string(to_string(model)),
                   "export undistorted images");
}

}  // namespace

const ColmapCameraModel* find_colmap_camera_model(std::int32_t id) {
  const auto found = std::ranges::find(kKinds, id, &ColmapCameraModel::id);
  return found == kKinds.end() ? nullptr : &*found;
}

const ColmapCameraModel* find_colmap_camera_model(std::string_view name) {
  const auto found = std::ranges::find(kKinds, name, &ColmapCameraModel::name);
  return found == kKinds.end() ? nullptr : &*found;
}

Camera camera_of(const ColmapCamera& camera, const std::string& place) {
  constexpr std::uint64_t kMaxSide = 20000;  // pixels
  const ColmapCameraModel* const kind = find_colmap_camera_model(camera.model);
  if (kind == nullptr || kind->parameters != camera.parameters.size()) {
    throw InputError(place, "has an unknown model or a wrong number of parameters");
  }
  if (camera.width == 0 || camera.height == 0 || camera.width > kMaxSide || camera.height > kMaxSide) {
    throw InputError(place, "the width or height is invalid");
  }
  Camera result = lens_of(camera, place);
  result.width = static_cast<int>(camera.width);
  result.height = static_cast<int>(camera.height);
  require_valid(result, place);
  return result;
}

ColmapCamera colmap_camera(const Camera& camera) {
  const auto is_zero_from = [&camera](int first) {
    return std::all_of(camera.distortion.begin() + first, camera.distortion.end(), [](double k) { return k == 0.0; });
  };
  const std::array<double, 14>& d = camera.distortion;
  ColmapCamera result{"",
                      static_cast<std::uint64_t>(camera.width),
                      static_cast<std::uint64_t>(camera.height),
                      {camera.fx, camera.fy, camera.cx + kHalf, camera.cy + kHalf}};
  switch (camera.model) {
    case CameraModel::pinhole:
      result.model = "PINHOLE";
      break;
    case CameraModel::radial_tangential:
      result.model = d[4] == 0.0 ? "OPENCV" : "FULL_OPENCV";
      result.parameters.insert(result.parameters.end(), d.begin(), d.begin() + 4);
      if (d[4] != 0.0) result.parameters.insert(result.parameters.end(), {d[4], 0.0, 0.0, 0.0});
      break;
    case CameraModel::equidistant:
      result.model = "OPENCV_FISHEYE";
      result.parameters.insert(result.parameters.end(), d.begin(), d.begin() + 4);
      break;
    case CameraModel::rational:
      if (!is_zero_from(8)) refuse_export(camera.model);
      result.model = "FULL_OPENCV";
      result.parameters.insert(result.parameters.end(), d.begin(), d.begin() + 8);
      break;
    case CameraModel::thin_prism_fisheye:
      result.model = "THIN_PRISM_FISHEYE";
      result.parameters.insert(result.parameters.end(), d.begin(), d.begin() + 8);
      break;
    case CameraModel::unified:
    case CameraModel::extended_unified:
    case CameraModel::double_sphere:
    case CameraModel::field_of_view:
      refuse_export(camera.model);
  }
  return result;
}

}  // namespace byre
