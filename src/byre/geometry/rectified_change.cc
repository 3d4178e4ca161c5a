#include "byre/geometry/rectified_change.h"

namespace byre {
namespace {

struct RectifiedView {
  const Camera& camera;
  const Eigen::Quaterniond& camera_from_rectified;
  const Rig& rig;
};

PixelGrid<Eigen::Vector2d> displacements(const RectifiedView& before, const RectifiedView& after) {
  return {before.rig.width, before.rig.height, [&](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
            const auto raw = before.camera.project(before.camera_from_rectified * before.rig.ray(pixel));
            const auto bearing = raw ? after.camera.bearing(*raw) : std::nullopt;
            if (!bearing) return Eigen::Vector2d::Zero();
            return after.rig.project(after.camera_from_rectified.conjugate() * *bearing).head<2>() - pixel;
          }};
}

const Camera& right_or_left(const Calibration& calibration) {
  return calibration.right ? calibration.right->camera : calibration.left;
}

const Eigen::Quaterniond& right_or_left(const Calibration& calibration, const Rectification& rectification) {
  return calibration.right ? rectification.right_from_rectified : rectification.left_from_rectified;
}

}  // namespace

RectifiedChange::RectifiedChange(const Calibration& before, const Calibration& after)
    : RectifiedChange(before, rectification_of(before), after, rectification_of(after)) {}

RectifiedChange::RectifiedChange(const Calibration& before, const Rectification& rectified_before,
                                 const Calibration& after, const Rectification& rectified_after)
    : rig_(rectified_after.rig),
      has_right_(before.right.has_value()),
      zoom_(rectified_after.rig.focal / rectified_before.rig.focal),
      after_from_before_{rectified_after.left_from_rectified.conjugate() * rectified_before.left_from_rectified,
                         Eigen::Vector3d::Zero()},
      left_(displacements({before.left, rectified_before.left_from_rectified, rectified_before.rig},
                          {after.left, rectified_after.left_from_rectified, rectified_after.rig})),
      right_(displacements({right_or_left(before), right_or_left(before, rectified_before), rectified_before.rig},
                           {right_or_left(after), right_or_left(after, rectified_after), rectified_after.rig})) {}

RectifiedChange::Corner RectifiedChange::operator()(const Corner& before) const {
  Corner after = before;
  const Eigen::Vector2d in_left = before.pixel.head<2>();
  after.pixel.head<2>() += left_.at(in_left);
  if (!(before.pixel.z() > 0.0)) return after;
  if (!has_right_) {
    after.pixel.z() *= zoom_;
    return after;
  }
  const Eigen::Vector2d in_right(in_left.x() - before.pixel.z(), in_left.y() + before.row_offset);
  const Eigen::Vector2d moved_in_right = in_right + right_.at(in_right);
  after.pixel.z() = after.pixel.x() - moved_in_right.x();
  after.row_offset = moved_in_right.y() - after.pixel.y();
  return after;
}

}  // namespace byre
