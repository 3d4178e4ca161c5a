#include "byre/dataset/bag_calibration.h"

#include "byre/calibration_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace byre {
namespace {

constexpr std::string_view kGiveFile = "name a calibration of the cameras: --calibration FILE";

// The first versions put a slash before names of frames.
std::string frame_name(const std::string& name) {
  return name.starts_with('/') ? name.substr(1) : name;
}

Pose pose_of(const ros::Transform& transform) {
  const auto& [t, q] = transform;
  return {Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized(), {t.x, t.y, t.z}};
}

bool is_uncalibrated(const ros::CameraInfo& info) {
  return !(info.k[0] > 0.0) || !(info.k[4] > 0.0);
}

// "plumb_bob" (k1, k2, p1, p2, k3), "rational_polynomial" without its last terms, "equidistant" (k1..k4).
void take_distortion(const PlacedCameraInfo& placed, Camera& camera) {
  const auto& [info, place, is_rectified] = placed;
  const auto is_zero = [](double coefficient) { return coefficient == 0.0; };
  if (std::ranges::all_of(info.d, is_zero)) return;
  const bool is_fisheye = info.distortion_model == "equidistant" || info.distortion_model == "fisheye";
  const bool is_radial = info.distortion_model == "plumb_bob" || info.distortion_model == "rational_polynomial";
  const std::size_t known = is_fisheye ? 4 : 5;
  const std::size_t count = std::min(known, info.d.size());
  if ((!is_fisheye && !is_radial) ||
      !std::all_of(info.d.begin() + static_cast<std::ptrdiff_t>(count), info.d.end(), is_zero)) {
    throw InputError(place,
                     "is of the lens model \"" + info.distortion_model + "\" with " + std::to_string(info.d.size()) +
                         " coefficients, which byre does not know",
                     "calibrate with plumb_bob (5) or equidistant (4), and " + std::string(kGiveFile));
  }
  camera.model = is_fisheye ? CameraModel::equidistant : CameraModel::radial_tangential;
  std::copy_n(info.d.begin(), count, camera.distortion.begin());
}

void require_whole_images(const PlacedCameraInfo& placed) {
  const ros::CameraInfo& info = placed.info;
  const bool is_cut = info.roi.width != 0 && (info.roi.width != info.width || info.roi.height != info.height);
  if (!is_cut && info.binning_x <= 1 && info.binning_y <= 1) return;
  throw InputError(placed.place, is_cut ? "is of images that are cut out" : "is of images that are binned",
                   "calibrate at the size of the images, and " + std::string(kGiveFile));
}

Eigen::Matrix3d rotation_of(const ros::CameraInfo& info) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.r.data());
}

// Translation of rectified frames: a point of the left one as the right one sees it.
Eigen::Vector3d shift_of(const ros::CameraInfo& right) {
  return {right.p[3] / right.p[0], right.p[7] / right.p[5], 0.0};
}

bool has_baseline(const ros::CameraInfo& right) {
  return right.p[0] > 0.0 && right.p[5] > 0.0 && right.p[3] != 0.0;
}

std::optional<Pose> by_projections(const PlacedCameraInfo& left, const PlacedCameraInfo& right) {
  if (!has_baseline(right.info)) return std::nullopt;
  if (right.is_rectified) return Pose{Eigen::Quaterniond::Identity(), shift_of(right.info)};
  const auto left_rotation = rotation_from_matrix(rotation_of(left.info));
  const auto right_rotation = rotation_from_matrix(rotation_of(right.info));
  if (!left_rotation || !right_rotation) return std::nullopt;
  const Pose rectified_from_left{*left_rotation, Eigen::Vector3d::Zero()};
  const Pose rectified_from_right{*right_rotation, Eigen::Vector3d::Zero()};
  return inverse(rectified_from_right) * Pose{Eigen::Quaterniond::Identity(), shift_of(right.info)} *
         rectified_from_left;
}

}  // namespace

void FrameTree::add(const ros::TFMessage& message) {
  for (const ros::TransformStamped& each : message.transforms) {
    parents_[frame_name(each.child_frame_id)] = {frame_name(each.header.frame_id), pose_of(each.transform)};
  }
}

std::vector<FrameTree::Parent> FrameTree::chain(const std::string& frame) const {
  std::vector<Parent> chain = {{frame_name(frame), Pose()}};
  for (auto above = parents_.find(chain.back().name); above != parents_.end() && chain.size() <= parents_.size();
       above = parents_.find(chain.back().name)) {
    chain.push_back({above->second.name, above->second.parent_from_child * chain.back().parent_from_child});
  }
  return chain;
}

std::optional<Pose> FrameTree::between(const std::string& a, const std::string& b) const {
  const std::vector<Parent> above_b = chain(b);
  for (const Parent& common : chain(a)) {
    const auto found = std::ranges::find(above_b, common.name, &Parent::name);
    if (found != above_b.end()) return inverse(common.parent_from_child) * found->parent_from_child;
  }
  return std::nullopt;
}

Camera camera_of(const PlacedCameraInfo& placed) {
  const ros::CameraInfo& info = placed.info;
  if (is_uncalibrated(info)) throw InputError(placed.place, "says that the camera is not calibrated", kGiveFile);
  require_whole_images(placed);
  Camera camera{.width = static_cast<int>(info.width), .height = static_cast<int>(info.height)};
  if (placed.is_rectified && info.p[0] > 0.0 && info.p[5] > 0.0) {
    camera.fx = info.p[0], camera.fy = info.p[5], camera.cx = info.p[2], camera.cy = info.p[6];
    return camera;
  }
  camera.fx = info.k[0], camera.fy = info.k[4], camera.cx = info.k[2], camera.cy = info.k[5];
  if (!placed.is_rectified) take_distortion(placed, camera);
  return camera;
}

StereoPartner partner_of(const PlacedCameraInfo& left, const PlacedCameraInfo& right, const FrameTree& frames) {
  std::optional<Pose> right_from_left = by_projections(left, right);
  if (!right_from_left) right_from_left = frames.between(right.info.header.frame_id, left.info.header.frame_id);
  if (!right_from_left) {
    throw InputError(right.place,
                     "has no baseline in P, and /tf_static does not lead from the frame \"" +
                         left.info.header.frame_id + "\" to \"" + right.info.header.frame_id + "\"",
                     kGiveFile);
  }
  StereoPartner partner{camera_of(right), *right_from_left};
  require_baseline(partner, right.place);
  return partner;
}

Pose body_from_camera(const std::string& camera_frame, const FrameTree& frames) {
  return frames.between("base_link", camera_frame).value_or(Pose());
}

}  // namespace byre
