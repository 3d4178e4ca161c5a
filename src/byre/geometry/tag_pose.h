#pragma once

#include "byre/rig.h"
#include "byre/tag.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// Corners of a tag of this size in its own frame, in the order of TagSighting::corners.
std::array<Eigen::Vector3d, 4> tag_corners(double size);

// Corners of a tag in an image of a camera with a known pose.
struct TagView {
  Pose camera_from_world;
  Rig rig;
  std::array<Eigen::Vector2d, 4> corners;  // pixels, see TagSighting
};

struct TagEstimate {
  Pose world_from_tag;
  Matrix6 covariance;  // covariance of delta in world_from_tag * exp_pose(delta)
  double error = 0.0;  // root mean square of the corners' distances, pixels
  int views = 0;       // views that agree with the pose
};

// Poses of a tag by its corners in one or more views, the best first: least squares of the corners' pixels with Huber's
// loss. A tag seen from one side only has a second pose that explains the corners about as well, turned about the
// viewing ray's normal (Schweighofer and Pinz 2006); it is returned unless the views exclude it. Empty if no pose
// explains most views.
std::vector<TagEstimate> estimate_tag_pose(std::span<const TagView> views, double size);

// Unit of length of the views' poses.
struct UnitEstimate {
  double lengths_per_metre = 1.0;
  double sigma = 0.0;  // standard deviation of the natural logarithm
};

// Estimates the unit by views of a tag, of which each measures the tag's position in metres: weighted least squares of
// one position of the tag in the world and the unit. size: metres. Empty if the views disagree, or do not determine the
// unit to 5 %.
std::optional<UnitEstimate> estimate_unit(std::span<const TagView> views, double size);

}  // namespace byre
