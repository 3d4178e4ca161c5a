#include "byre/ros2/node/map_messages.h"

#include "byre/input_error.h"
#include "byre/map/point_grey.h"
#include "byre/map/stored_calibration.h"
#include "byre/playback/report/ros_report.h"

#include <cmath>
#include <cstring>

namespace byre {
namespace {

// Side of a square, unmirrored pixel in metres; the rotation is left for the grid's origin.
double side_of_pixel(const FloorPlan& plan) {
  const Eigen::Vector2d right = plan.metres_per_pixel.col(0), up = -plan.metres_per_pixel.col(1);
  constexpr double kMaxSkew = 1e-3;
  const double side = right.norm();
  if ((Eigen::Vector2d(-right.y(), right.x()) - up).norm() > kMaxSkew * side) {
    throw InputError(plan.image.string(), "has non-square pixels, which an occupancy grid cannot represent",
                     "scale the image to square pixels, or leave slam.plan empty");
  }
  return side;
}

ros::OccupancyGrid grid_message(const FloorPlan& plan, const std::vector<std::int8_t>& occupancy,
                                const Pose& published_from_plan) {
  ros::OccupancyGrid grid;
  grid.info.resolution = static_cast<float>(side_of_pixel(plan));
  grid.info.width = static_cast<std::uint32_t>(plan.width);
  grid.info.height = static_cast<std::uint32_t>(plan.height);
  const Eigen::Vector2d corner = plan.point_at({-0.5, plan.height - 0.5});
  const Eigen::Vector2d right = plan.metres_per_pixel.col(0);
  const Eigen::AngleAxisd turn(std::atan2(right.y(), right.x()), Eigen::Vector3d::UnitZ());
  grid.info.origin = ros_pose(published_from_plan * Pose{Eigen::Quaterniond(turn), {corner.x(), corner.y(), 0.0}});
  grid.data.reserve(occupancy.size());
  for (int row = plan.height - 1; row >= 0; --row) {  // from the bottom row up
    const auto begin = occupancy.begin() + static_cast<std::ptrdiff_t>(row) * plan.width;
    grid.data.insert(grid.data.end(), begin, begin + plan.width);
  }
  return grid;
}

}  // namespace

ros::OccupancyGrid grid_of(const FloorPlan& plan) {
  return grid_message(plan, read_plan_pixels(plan).occupancy, {});
}

ros::OccupancyGrid grid_of(const OccupancyGrid& grid, bool in_plan) {
  const Pose map_from_plan = inverse(grid.plan_from_map.target_from_source);
  return grid_message(grid.plan, grid.occupancy, in_plan ? Pose{} : map_from_plan);
}

ros::OccupancyGrid grid_of(const StoredMap& stored, bool in_plan, const GridOptions& options) {
  const auto registration = in_plan ? stored.plan : std::nullopt;
  if (stored.scale != MapScale::metric && !registration) {
    throw InputError("the map", "has no metric scale, which occupancy grids need",
                     "set it with byre scale or byre register");
  }
  const auto grid =
      occupancy_grid(stored.map, registration, options, fit_driving_plane(stored.map, up_of_base(stored)));
  if (!grid) {
    throw InputError("the map", "was not driven on a floor, so it has no occupancy grid",
                     "set grid.from_map: false, or map with a camera on a wheeled robot");
  }
  return grid_of(*grid, registration.has_value());
}

ros::OccupancyGrid unknown_grid() {
  ros::OccupancyGrid grid;
  grid.info.resolution = 0.05f;
  grid.info.width = grid.info.height = 1;
  grid.info.origin = ros_pose({});
  grid.data = {kUnknownPixel};
  return grid;
}

CloudPoint cloud_point(const Eigen::Vector3d& position, std::optional<std::uint8_t> grey) {
  CloudPoint point;
  point << position.cast<float>(), static_cast<float>(grey.value_or(kUnknownGrey));
  return point;
}

std::vector<CloudPoint> points_of(const std::filesystem::path& map, bool in_plan) {
  const StoredMap stored = load_map(map);
  std::vector<CloudPoint> points;
  for (const PointId id : stored.map.point_ids()) {
    const MapPoint& point = *stored.map.find_point(id);
    const Eigen::Vector3d& in_map = point.position_in_world;
    const Eigen::Vector3d placed = in_plan && stored.plan ? stored.plan->plan_from_map * in_map : in_map;
    points.push_back(cloud_point(placed, grey_of(stored.map, point)));
  }
  return points;
}

ros::PointCloud2 cloud_message(const ros::Header& header, const std::vector<CloudPoint>& points) {
  ros::PointCloud2 cloud;
  cloud.header = header;
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(points.size());
  cloud.point_fields = {{"x", 0, ros::PointField::kFloat32, 1},
                        {"y", 4, ros::PointField::kFloat32, 1},
                        {"z", 8, ros::PointField::kFloat32, 1},
                        {"intensity", 12, ros::PointField::kFloat32, 1}};
  cloud.point_step = sizeof(CloudPoint);
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(cloud.row_step);
  if (!points.empty()) std::memcpy(cloud.data.data(), points.data(), cloud.data.size());
  cloud.is_dense = true;
  return cloud;
}

ros::Path path_message(const ros::Header& header, const Trajectory& trajectory,
                       const std::function<Pose(const Pose&)>& published) {
  constexpr std::size_t kMaxPoses = 5000;
  ros::Path path;
  path.header = header;
  const std::size_t stride = trajectory.size() / kMaxPoses + 1;
  for (std::size_t i = 0; i < trajectory.size(); i += stride) {
    ros::Header stamped = header;
    stamped.stamp = ros::to_time(trajectory[i].time);
    path.poses.push_back({stamped, ros_pose(published(trajectory[i].world_from_body))});
  }
  return path;
}

}  // namespace byre
