#pragma once

#include "byre/map/map_file.h"
#include "byre/map/plan/floor_plan.h"
#include "byre/tag.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// A position in the map that was recognised, to be located on a floor plan.
struct MapPosition {
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // in the map's unit; zero for points of a map without a scale
};

// A pixel of a keyframe's rectified left image, in the coordinates of its rig.
struct KeyframePixel {
  KeyframeId keyframe;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

// Conversion between a pixel of a keyframe's left image as recorded and of its rectified image. Empty outside the field
// of view of the lens or the rig, or if the map does not contain the recording's camera.
std::optional<Eigen::Vector2d> rectified_pixel(const StoredMap& stored, const Keyframe& keyframe,
                                               const Eigen::Vector2d& recorded);
std::optional<Eigen::Vector2d> recorded_pixel(const StoredMap& stored, const Keyframe& keyframe,
                                              const Eigen::Vector2d& rectified);

// Empty if the point does not exist.
std::optional<MapPosition> position_of_point(const StoredMap& stored, PointId id);

// The map point observed by the keyframe nearest to a pixel of its left camera's original image. The distance in pixels
// adds to the covariance. Empty without a point within 10 pixels, or if the map does not contain the recording's
// camera.
std::optional<MapPosition> position_at_pixel(const StoredMap& stored, const Keyframe& keyframe,
                                             const Eigen::Vector2d& pixel);

// Standard deviation of a pixel picked by hand in a keyframe's picture, pixels of the rig.
double picked_pixel_sigma(const Rig& rig);

// Point seen at pixels of two or more keyframes, which need not be a point of the map, by least squares of the
// reprojection errors. The covariance is that of the pixels and of the first keyframe's pose.
struct TriangulatedPoint {
  MapPosition position;
  double error = 0.0;         // root mean square of the reprojection errors, sigmas
  bool is_same_place = true;  // whether the error is explained by its sigma; else the pixels are of different places
};
// Empty with fewer than two keyframes, and if their rays are within half a degree or meet behind a camera.
std::optional<TriangulatedPoint> triangulate_pixels(const MapGraph& map, std::span<const KeyframePixel> pixels);

// Point of the floor seen at a pixel. The covariance is that of the pixel and of the height and tilt of the floor.
// Empty for pixels less than 3 degrees below the horizon. body_height: of the body's origin above the floor.
std::optional<MapPosition> floor_at_pixel(const MapGraph& map, const KeyframePixel& pixel, const DrivingPlane& plane,
                                          double body_height);

// pick_sigma: of x and of y on the plan, metres.
PlanCorrespondence correspondence(std::string name, const MapPosition& place, const Eigen::Vector2d& point_in_plan,
                                  double pick_sigma);
PlanCorrespondence wall_correspondence(std::string name, const MapPosition& start, const MapPosition& end,
                                       const Eigen::Vector2d& start_in_plan, const Eigen::Vector2d& end_in_plan,
                                       double pick_sigma);

// Centres of the surveyed tags that the map has.
std::vector<PlanCorrespondence> tag_correspondences(const StoredMap& stored, std::span<const Tag> tags);

}  // namespace byre
