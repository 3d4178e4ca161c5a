#include "byre/simulation/cowshed/cowshed_plan.h"

#include "byre/base/output_file.h"
#include "byre/geometry/degrees.h"
#include "byre/io/image/image_codec.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr double kMargin = 1.0;  // metres around the building
constexpr std::uint8_t kFree = 254;
constexpr std::uint8_t kOccupied = 0;

// write: callable that takes the stream.
template <typename Write>
void write_fixed_text(const fs::path& path, Write write) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(6);
  write(text);
  write_atomically(path, text.view());
}

void write_plan_image(const fs::path& path, const Image& image) {
  cv::Mat pixels(image.height, image.width, CV_8UC1);
  std::ranges::copy(image.pixels, pixels.data);
  write_image_file(path, pixels);
}

}  // namespace

FloorPlanImage draw_floor_plan(const std::vector<PlanOutline>& outlines) {
  FloorPlanImage plan;
  plan.origin = {-kMargin, -kCowshedSize.half_width - kMargin};
  const double length = kCowshedSize.length + kCowshedSize.store_length;
  const int width = static_cast<int>(std::lround((length + 2.0 * kMargin) / plan.resolution));
  const int height = static_cast<int>(std::lround((2.0 * kCowshedSize.half_width + 2.0 * kMargin) / plan.resolution));
  cv::Mat pixels(height, width, CV_8UC1, cv::Scalar(kFree));
  const auto pixel_of = [&](const Eigen::Vector2d& point) {  // integers are pixel centres
    const Eigen::Vector2d cell = (point - plan.origin) / plan.resolution - Eigen::Vector2d::Constant(0.5);
    return cv::Point(static_cast<int>(std::lround(cell.x())), height - 1 - static_cast<int>(std::lround(cell.y())));
  };
  for (const PlanOutline& outline : outlines) {
    std::vector<cv::Point> corners;
    for (const Eigen::Vector2d& corner : outline.corners_in_world) corners.push_back(pixel_of(corner));
    cv::fillConvexPoly(pixels, corners, cv::Scalar(kOccupied));
  }
  plan.image = {width, height, std::vector<std::uint8_t>(pixels.data, pixels.data + pixels.total())};
  return plan;
}

std::vector<MarkPick> picks_of(const std::vector<NamedPoint>& marks, const Pose& world_from_first_body) {
  const Pose map_from_world = inverse(world_from_first_body);
  std::vector<MarkPick> picks;
  for (const NamedPoint& mark : marks) {
    picks.push_back({mark.name, map_from_world * mark.point_in_world, mark.point_in_world.head<2>()});
  }
  return picks;
}

void write_tags(const std::vector<Tag>& tags, const fs::path& path) {
  write_fixed_text(path, [&](std::ostream& file) {
    file << "tags:\n";
    for (const Tag& tag : tags) {
      const Eigen::Vector3d& position = tag.survey->position;
      file << "  - {id: " << tag.id.number << ", family: " << to_string(tag.id.family) << ", size: " << tag.size
           << ", position: [" << position.x() << ", " << position.y() << ", " << position.z()
           << "], heading_deg: " << *tag.survey->heading / kDegree << ", sigma_m: " << tag.survey->sigma << "}\n";
    }
  });
}

void write_floor_plan(const FloorPlanImage& plan, const std::vector<MarkPick>& picks,
                      const std::vector<MarkSighting>& sightings, const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  write_plan_image(folder / "plan.png", plan.image);
  write_fixed_text(folder / "plan.yaml", [&](std::ostream& file) {
    file << "image: plan.png\nresolution: " << plan.resolution << "\norigin: [" << plan.origin.x() << ", "
         << plan.origin.y() << ", 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  });
  write_fixed_text(folder / "picks.csv", [&](std::ostream& file) {
    file << "#point_x_m,point_y_m,point_z_m,plan_x_m,plan_y_m,name\n";
    for (const MarkPick& pick : picks) {
      for (const double value : pick.point_in_map) file << value << ",";
      for (const double value : pick.point_in_plan) file << value << ",";
      file << pick.name << "\n";
    }
  });
  write_fixed_text(folder / "pick_pixels.csv", [&](std::ostream& file) {
    file << "#time_ns,u_px,v_px,name\n";
    for (const MarkSighting& sighting : sightings) {
      file << sighting.time.count() << "," << sighting.pixel.x() << "," << sighting.pixel.y() << "," << sighting.name
           << "\n";
    }
  });
}

}  // namespace byre
