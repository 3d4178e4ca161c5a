#include "byre/floor_plan.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/calibration/yaml_mapping.h"
#include "byre/io/image/image_file.h"
#include "byre/io/image/image_size.h"
#include "byre/io/image/plan_file.h"
#include "byre/site.h"

#include <array>

#include <Eigen/Geometry>
#include <yaml-cpp/yaml.h>

#include <fmt/format.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr double kSmallestPixel = 1e-4;  // metres; smaller values may be degrees
constexpr double kLargestPixel = 100.0;  // metres
constexpr double kFarthest = 1e9;        // metres, largest coordinate of a projected system

void read_image_size(FloorPlan& plan) {
  const std::optional<ImageSize> size = stated_size(plan.image);
  if (size && size->pixels() > kMaxPixels) {
    throw InputError(plan.image.string(),
                     "has " + std::to_string(size->width) + " x " + std::to_string(size->height) +
                         " pixels; the limit for floor plans is 100 million",
                     "reduce the image and increase its resolution value (metres per pixel)");
  }
  const std::optional<Image> image = read_image(plan.image);
  if (!image) {
    throw InputError(plan.image.string(), "cannot be read as the image of a floor plan",
                     "check that it exists and is a PNG, JPEG, TIFF or PGM image");
  }
  plan.width = image->width;
  plan.height = image->height;
}

double to_number(const YAML::Node& node, const std::string& place) {
  const std::optional<double> number = node && node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
  if (!number) throw InputError(place, node ? "is not a number" : "is missing");
  return *number;
}

double read_resolution(const YAML::Node& root, const fs::path& path) {
  const std::string place = path.string() + ": resolution";
  const double resolution = to_number(root["resolution"], place);
  if (resolution <= 0.0) throw InputError(place, "is not positive", "give metres per pixel, such as 0.05");
  if (resolution < kSmallestPixel || resolution > kLargestPixel) {
    throw InputError(place, fmt::format("is {:g} metres per pixel, outside 0.0001 to 100", resolution),
                     "give metres per pixel, such as 0.05");
  }
  return resolution;
}

struct PlanOrigin {
  Eigen::Vector2d corner_in_plan;
  double yaw = 0.0;  // radians
};

PlanOrigin read_origin(const YAML::Node& root, const fs::path& path) {
  const std::string place = path.string() + ": origin";
  const YAML::Node origin = root["origin"];
  if (!origin) throw InputError(place, "is missing");
  if (!origin.IsSequence() || origin.size() != 3) {
    throw InputError(place, "is not a list of three numbers", "give x, y and yaw of the lower left corner");
  }
  const PlanOrigin read{{to_number(origin[0], place), to_number(origin[1], place)}, to_number(origin[2], place)};
  if (read.corner_in_plan.cwiseAbs().maxCoeff() <= kFarthest) return read;
  throw InputError(place, "is more than a million kilometres away", "give x and y in metres");
}

fs::path read_image_path(const YAML::Node& root, const fs::path& path) {
  const YAML::Node image = root["image"];
  if (!image || !image.IsScalar()) throw InputError(path.string() + ": image", "is missing");
  return path.parent_path() / image.Scalar();  // keeps absolute paths
}

std::optional<double> read_occupied_threshold(const YAML::Node& root, const fs::path& path) {
  if (!root["occupied_thresh"]) return std::nullopt;
  const std::string place = path.string() + ": occupied_thresh";
  const double threshold = to_number(root["occupied_thresh"], place);
  if (!(threshold > 0.0 && threshold <= 1.0)) throw InputError(place, "is not between 0 and 1");
  return threshold;
}

double read_free_threshold(const YAML::Node& root, const fs::path& path, double usual) {
  if (!root["free_thresh"]) return usual;
  const std::string place = path.string() + ": free_thresh";
  const double threshold = to_number(root["free_thresh"], place);
  if (!(threshold >= 0.0 && threshold <= 1.0)) throw InputError(place, "is not between 0 and 1");
  return threshold;
}

// A whole number, or a boolean in any spelling of YAML.
bool read_is_negated(const YAML::Node& root, const fs::path& path) {
  const YAML::Node negate = root["negate"];
  if (!negate) return false;
  int number = 0;
  bool is_true = false;
  if (YAML::convert<int>::decode(negate, number)) return number != 0;
  if (YAML::convert<bool>::decode(negate, is_true)) return is_true;
  throw InputError(path.string() + ": negate", "is not 0, 1, true or false", "give 1 if white is occupied, else 0");
}

PlanMode read_mode(const YAML::Node& root, const fs::path& path) {
  const YAML::Node mode = root["mode"];
  if (!mode) return PlanMode::trinary;
  const std::string word = mode.IsScalar() ? lower_case(mode.Scalar()) : "";
  if (word == "trinary") return PlanMode::trinary;
  if (word == "scale") return PlanMode::scale;
  if (word == "raw") return PlanMode::raw;
  throw InputError(path.string() + ": mode", "is not trinary, scale or raw", "omit it for trinary");
}

void require_scale(const FloorPlan& plan, const fs::path& path) {
  if (plan.mode != PlanMode::scale || plan.free_threshold < plan.occupied_threshold.value_or(1.0)) return;
  throw InputError(path.string() + ": free_thresh", "is not below occupied_thresh, which mode scale requires");
}

FloorPlan read_map_server_plan(const fs::path& path) {
  const YAML::Node root = load_yaml_mapping(path);
  FloorPlan plan;
  plan.name = path.filename().string();
  plan.image = read_image_path(root, path);
  const double resolution = read_resolution(root, path);
  const auto [corner_in_plan, yaw] = read_origin(root, path);
  plan.occupied_threshold = read_occupied_threshold(root, path);
  plan.free_threshold = read_free_threshold(root, path, plan.free_threshold);
  plan.is_negated = read_is_negated(root, path);
  plan.mode = read_mode(root, path);
  require_scale(plan, path);
  read_image_size(plan);
  const Eigen::Matrix2d plan_from_corner = Eigen::Rotation2Dd(yaw).toRotationMatrix();
  plan.metres_per_pixel = resolution * plan_from_corner * Eigen::Vector2d(1.0, -1.0).asDiagonal();
  plan.top_left_in_plan = corner_in_plan + resolution * plan_from_corner * Eigen::Vector2d(0.5, plan.height - 0.5);
  return plan;
}

std::array<double, 6> read_six_numbers(const fs::path& path) {
  const std::vector<TextLine> lines = read_lines(path);
  std::array<double, 6> numbers{};
  if (lines.size() != numbers.size()) {
    throw InputError(path.string(), "has " + std::to_string(lines.size()) + " lines instead of six");
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<double> number = parse_number(lines[i].text);
    if (!number) throw InputError(place_of(path, lines[i]), "is not a number");
    numbers[i] = *number;
  }
  return numbers;
}

bool is_description(const fs::path& plan) {
  return plan.extension() == ".yaml" || plan.extension() == ".yml";
}

void require_sound_pixels(const FloorPlan& plan, const fs::path& world_file) {
  if (plan.metres_per_pixel.colwise().norm().minCoeff() < kSmallestPixel) {
    throw InputError(world_file.string(), "has pixels smaller than 0.1 mm",
                     "if its unit is degrees, reproject the plan to a coordinate system in metres, such as UTM");
  }
  const double farthest = plan.top_left_in_plan.cwiseAbs().maxCoeff();
  if (plan.metres_per_pixel.cwiseAbs().maxCoeff() > kLargestPixel || farthest > kFarthest) {
    throw InputError(world_file.string(),
                     "has pixels larger than 100 m, or an origin more than a million kilometres away",
                     "give values in metres");
  }
  const double turn = plan.metres_per_pixel.determinant();  // sign of the orientation: rows go down, y goes up
  if (turn >= 0.0) throw InputError(world_file.string(), "has a mirrored or degenerate transform");
}

FloorPlan read_geo_referenced_plan(const fs::path& path) {
  FloorPlan plan;
  plan.name = path.filename().string();
  plan.image = path;
  read_image_size(plan);
  const std::optional<fs::path> world_file = find_world_file(path);
  if (!world_file) {
    throw InputError(path.string(), "has no world file in its folder, so its position and scale are unknown",
                     "add a world file, or give the YAML file of a map_server map");
  }
  const std::array<double, 6> numbers = read_six_numbers(*world_file);
  plan.metres_per_pixel << numbers[0], numbers[2], numbers[1], numbers[3];
  plan.top_left_in_plan << numbers[4], numbers[5];
  require_sound_pixels(plan, *world_file);
  return plan;
}

}  // namespace

DrawnFloorPlan read_drawn_floor_plan(const fs::path& path) {
  return read_plan_pixels(read_floor_plan(path));
}

Site read_site_with_plans(const fs::path& path) {
  Site site = read_site(path);
  for (SiteMap& map : site.maps) {
    if (map.plan) map.drawn_plan = read_drawn_floor_plan(*map.plan);
  }
  return site;
}

std::optional<fs::path> find_world_file(const fs::path& image) {
  const std::string extension = image.extension().string();
  if (extension.size() < 3) return std::nullopt;
  const std::array<std::string, 3> extensions = {{{'.', extension[1], extension.back(), 'w'}, extension + "w", ".wld"}};
  for (const std::string& other : extensions) {
    const fs::path path = fs::path(image).replace_extension(other);
    if (fs::exists(path)) return path;
  }
  return std::nullopt;
}

FloorPlan read_floor_plan(const fs::path& path) {
  return is_description(path) ? read_map_server_plan(path) : read_geo_referenced_plan(path);
}

std::array<fs::path, 2> files_to_copy(const fs::path& plan) {
  const DrawnFloorPlan drawn = read_drawn_floor_plan(plan);
  if (!is_description(plan)) return {plan, find_world_file(plan).value()};
  const fs::path image = load_yaml_mapping(plan)["image"].Scalar();
  if (!image.has_parent_path()) return {plan, drawn.plan.image};
  throw InputError(plan.string() + ": image", "is in another folder: " + image.string(),
                   "put the image beside this file, and give its name alone: " + image.filename().string());
}

}  // namespace byre
