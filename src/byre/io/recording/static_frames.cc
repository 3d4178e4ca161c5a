#include "byre/io/recording/static_frames.h"

#include <cmath>

namespace byre {

std::string frame_without_slash(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

std::optional<Pose> pose_of_transform(const ros::Transform& transform) {
  const auto& [x, y, z, w] = transform.rotation;
  const Eigen::Vector3d translation(transform.translation.x, transform.translation.y, transform.translation.z);
  const Eigen::Quaterniond rotation(w, x, y, z);
  constexpr double kMaxRoundingError = 0.01;
  const bool is_rotation = std::abs(rotation.norm() - 1.0) < kMaxRoundingError;
  if (!is_rotation || !translation.allFinite()) return std::nullopt;
  return Pose{rotation.normalized(), translation};
}

void StaticFrames::take(const ros::TFMessage& message) {
  constexpr std::size_t kMaxFrames = 1000;
  for (const ros::TransformStamped& each : message.transforms) {
    const std::string child = frame_without_slash(each.child_frame_id),
                      parent = frame_without_slash(each.header.frame_id);
    const auto pose = pose_of_transform(each.transform);
    if (!pose || child.empty() || parent.empty() || child == parent) continue;
    if (parents_.size() >= kMaxFrames && !parents_.contains(child)) continue;
    parents_[child] = {parent, *pose};
  }
}

std::map<std::string, Pose> StaticFrames::ancestors(const std::string& frame) const {
  std::map<std::string, Pose> chain{{frame, Pose{}}};
  Pose up_from_frame;
  for (auto parent = parents_.find(frame); parent != parents_.end(); parent = parents_.find(parent->second.name)) {
    up_from_frame = parent->second.parent_from_child * up_from_frame;
    if (!chain.emplace(parent->second.name, up_from_frame).second) return chain;  // circular
  }
  return chain;
}

std::optional<Pose> StaticFrames::between(const std::string& a, const std::string& b) const {
  const std::map<std::string, Pose> above_a = ancestors(frame_without_slash(a));
  for (const auto& [frame, frame_from_b] : ancestors(frame_without_slash(b))) {
    const auto common = above_a.find(frame);
    if (common != above_a.end()) return inverse(common->second) * frame_from_b;
  }
  return std::nullopt;
}

}  // namespace byre
