#include "byre/slam/loops/part_placement.h"

#include "byre/alignment.h"
#include "byre/slam/loops/odometry_lengths.h"
#include "byre/slam/tracking/body_pose.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace byre {
namespace {

// The parts of the window's keyframes, each named by one of its keyframes.
class Parts {
 public:
  explicit Parts(const MapWindow& window) : parent_(window.keyframes.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (const WindowPoint& point : window.points) {
      if (point.removed || point.observations.empty()) continue;
      for (const WindowObservation& seen : point.observations) join(seen.keyframe, point.observations.front().keyframe);
    }
    for (int& parent : parent_) parent = part_of(parent);
  }

  int part_of(int keyframe) const {
    while (parent_[static_cast<std::size_t>(keyframe)] != keyframe) {
      keyframe = parent_[static_cast<std::size_t>(keyframe)];
    }
    return keyframe;
  }

 private:
  void join(int first, int second) {
    const auto [low, high] = std::minmax({part_of(first), part_of(second)});
    parent_[static_cast<std::size_t>(high)] = low;
  }

  std::vector<int> parent_;
};

Pose world_from_body(const MapWindow& window, int keyframe) {
  const WindowKeyframe& entry = window.keyframes[static_cast<std::size_t>(keyframe)];
  return body_pose(window.rig_of(entry), entry.keyframe.camera_from_world);
}

// Scale of each monocular part relative to measured motion; missing with too few motions.
std::map<int, double> lengths_of_parts(const MapWindow& window, const Parts& parts) {
  constexpr int kFew = 3;
  std::map<int, LengthRatio> ratios;
  for (const WindowMotion& motion : window.motions) {
    const int part = parts.part_of(motion.earlier);
    const WindowKeyframe& earlier = window.keyframes[static_cast<std::size_t>(motion.earlier)];
    if (part != parts.part_of(motion.later) || window.rig_of(earlier).is_stereo()) continue;
    ratios[part].add(motion.motion,
                     inverse(world_from_body(window, motion.earlier)) * world_from_body(window, motion.later));
  }
  std::map<int, double> lengths;
  for (const auto& [part, ratio] : ratios) {
    if (ratio.count() >= kFew && ratio.value()) lengths[part] = *ratio.value();
  }
  return lengths;
}

void move_part(MapWindow& window, const Parts& parts, int part, const Similarity& after_from_before) {
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    if (parts.part_of(static_cast<int>(i)) != part) continue;
    Pose& pose = window.keyframes[i].keyframe.camera_from_world;
    pose = move_camera(after_from_before, pose);
  }
  const auto scale = static_cast<float>(after_from_before.scale);
  for (WindowPoint& point : window.points) {
    if (point.removed || point.observations.empty()) continue;
    if (parts.part_of(point.observations.front().keyframe) != part) continue;
    point.point.position_in_world = after_from_before * point.point.position_in_world;
    point.point.min_distance *= scale;
    point.point.max_distance *= scale;
  }
}

// Moves the part of the later keyframe to the pose predicted from the earlier one, with lengths scaled by growth.
Similarity placement(const MapWindow& window, const WindowMotion& motion, double growth) {
  const Pose before = world_from_body(window, motion.later);
  return {growth, world_from_body(window, motion.earlier) * motion.motion.last_from_body *
                      inverse(scale_lengths(before, growth))};
}

}  // namespace

bool place_parts(MapWindow& window) {
  if (window.motions.empty()) return false;
  const Parts parts(window);
  if (std::ranges::none_of(window.motions, [&](const WindowMotion& motion) {
        return parts.part_of(motion.earlier) != parts.part_of(motion.later);
      })) {
    return false;
  }
  std::vector<bool> is_placed(window.keyframes.size(), false);  // by part
  const auto note_placed = [&](int keyframe) { is_placed[static_cast<std::size_t>(parts.part_of(keyframe))] = true; };
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    if (!window.keyframes[i].movable) note_placed(static_cast<int>(i));
  }
  const std::map<int, double> lengths = lengths_of_parts(window, parts);
  const auto length_of = [&](int part, double otherwise) {
    const auto found = lengths.find(part);
    return found == lengths.end() ? otherwise : found->second;
  };
  const auto time_of = [&](const WindowMotion& motion) {
    return window.keyframes[static_cast<std::size_t>(motion.later)].keyframe.frame.time;
  };
  std::ranges::sort(window.motions, {}, time_of);
  const int first = window.motions.front().earlier;
  const double first_length = length_of(parts.part_of(first), 1.0);
  note_placed(first);
  for (WindowMotion& motion : window.motions) motion.motion = scale_motion(motion.motion, first_length);
  for (const WindowMotion& motion : window.motions) {
    const int before = parts.part_of(motion.earlier), part = parts.part_of(motion.later);
    if (is_placed[static_cast<std::size_t>(part)] || !is_placed[static_cast<std::size_t>(before)]) continue;
    move_part(window, parts, part, placement(window, motion, first_length / length_of(part, first_length)));
    note_placed(part);
  }
  return true;
}

}  // namespace byre
