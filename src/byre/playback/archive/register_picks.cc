#include "byre/playback/archive/register_picks.h"

#include "byre/base/csv_table.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/map/plan/driving_plane.h"
#include "byre/map/stored_calibration.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <initializer_list>
#include <iterator>
#include <span>
#include <string>
#include <string_view>

#include <fmt/core.h>

namespace byre {
namespace {

using std::string_view_literals::operator""sv;
using Columns = std::span<const std::string_view>;

constexpr std::array kName = {"name"sv};
constexpr std::array kSigma = {"sigma_m"sv};
constexpr std::array kPlanMetres = {"plan_x_m"sv, "plan_y_m"sv};
constexpr std::array kPlanPixel = {"plan_column_px"sv, "plan_row_px"sv};
constexpr std::array kPoint = {"point"sv};
constexpr std::array kPosition = {"map_x_m"sv, "map_y_m"sv, "map_z_m"sv};
constexpr std::array kPositionOfPoint = {"point_x_m"sv, "point_y_m"sv, "point_z_m"sv};  // aliases of kPosition
constexpr std::array kBody = {"time_s"sv};
constexpr std::array kImagePixel = {"time_ns"sv, "u_px"sv, "v_px"sv};
constexpr std::array kEndPixel = {"u_end_px"sv, "v_end_px"sv};  // end of a wall, in the same image
constexpr std::array kPlanEnd = {"plan_end_x_m"sv, "plan_end_y_m"sv};

constexpr auto kNearestKeyframe = std::chrono::milliseconds(1);

std::vector<std::string_view> all_columns() {
  std::vector<std::string_view> all;
  for (const Columns columns :
       std::initializer_list<Columns>{kName, kSigma, kPlanMetres, kPlanPixel, kPoint, kPosition, kPositionOfPoint,
                                      kBody, kImagePixel, kEndPixel, kPlanEnd}) {
    all.insert(all.end(), columns.begin(), columns.end());
  }
  return all;
}

// The row that is parsed.
class Pick {
 public:
  Pick(const CsvTable& table, const CsvTable::Row& row) : table_(table), row_(row) {}

  [[noreturn]] void fail(const std::string& reason, const std::string& remedy) const {
    throw InputError(table_.place_of(row_), reason, remedy);
  }

  bool has(Columns columns) const {
    return std::ranges::any_of(columns,
                               [this](std::string_view column) { return table_.find(row_, column).has_value(); });
  }

  // Requires exactly one of several alternatives, each with columns of its own.
  void require_one(std::initializer_list<Columns> ways, const std::string& what, const std::string& remedy) const {
    const auto count = std::ranges::count_if(ways, [this](Columns columns) { return has(columns); });
    if (count == 0) fail("does not give " + what, remedy);
    if (count > 1) fail("gives " + what + " twice", remedy);
  }

  std::string text(std::string_view column) const { return std::string(table_.find(row_, column).value_or("")); }

  double number(std::string_view column) const {
    const std::optional<double> value = parse_number(text(column));
    if (!value) fail("has no number in " + std::string(column), "give a number with a decimal point");
    return *value;
  }

  std::string name() const { return has(kName) ? text(kName[0]) : "row " + std::to_string(row_.line); }

 private:
  const CsvTable& table_;
  const CsvTable::Row& row_;
};

Eigen::Vector2d read_point_in_plan(const Pick& pick, const FloorPlan& plan) {
  pick.require_one({kPlanMetres, kPlanPixel}, "its position on the plan",
                   "fill in plan_x_m and plan_y_m, or plan_column_px and plan_row_px");
  if (pick.has(kPlanMetres)) return {pick.number(kPlanMetres[0]), pick.number(kPlanMetres[1])};
  return plan.point_at({pick.number(kPlanPixel[0]), pick.number(kPlanPixel[1])});
}

MapPosition read_point(const Pick& pick, const StoredMap& stored) {
  const double number = pick.number(kPoint[0]);
  const auto whole = static_cast<std::uint32_t>(std::clamp(number, 0.0, 4294967295.0));
  const auto place = position_of_point(stored, {stored.map.origin(), whole});
  if (!place || number != whole) {
    pick.fail("refers to point " + pick.text(kPoint[0]) + ", which is not in the map",
              "the map has " + std::to_string(stored.map.point_count()) + " points, numbered from 0");
  }
  return *place;
}

std::string seconds_text(Timestamp time) {
  const auto [whole, rest] = std::lldiv(time.count(), 1'000'000'000);
  const std::string digits = std::to_string(1'000'000'000 + std::abs(rest));
  return std::to_string(whole) + "." + digits.substr(1);
}

// The keyframe nearest in time; fails unless exactly one is within kNearestKeyframe.
KeyframeId find_keyframe_at(const Pick& pick, Timestamp time, const MapGraph& map) {
  std::optional<KeyframeId> nearest;
  Timestamp nearest_time{};
  int count = 0;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Timestamp at = map.keyframe_header(id)->frame.time;
    const Timestamp gap = std::chrono::abs(at - time);
    if (!nearest || gap < std::chrono::abs(nearest_time - time)) {
      nearest = id;
      nearest_time = at;
    }
    if (gap <= kNearestKeyframe) ++count;
  }
  if (!nearest) pick.fail("refers to a keyframe, but the map has none", "map a recording first");
  if (count == 0) {
    pick.fail("has a time without keyframe", "the nearest keyframe is at " + seconds_text(nearest_time) + " s");
  }
  if (count > 1) pick.fail("has a time of two keyframes", "give the position instead");
  return *nearest;
}

MapPosition read_body(const Pick& pick, const StoredMap& stored) {
  const std::optional<Timestamp> time = parse_seconds(pick.text(kBody[0]));
  if (!time) pick.fail("has no time in seconds in time_s", "give the time stamp of a keyframe");
  return {body_at(stored.map, *stored.map.find_keyframe(find_keyframe_at(pick, *time, stored.map)))};
}

KeyframeId read_keyframe(const Pick& pick, const MapGraph& map) {
  const std::optional<Timestamp> time = parse_nanoseconds(pick.text(kImagePixel[0]));
  if (!time) pick.fail("has no integer in time_ns", "give the time stamp of a keyframe's image");
  return find_keyframe_at(pick, *time, map);
}

Eigen::Vector2d read_pair(const Pick& pick, std::string_view first, std::string_view second) {
  return {pick.number(first), pick.number(second)};
}

MapPosition read_image_pixel(const Pick& pick, const StoredMap& stored) {
  const Keyframe& keyframe = *stored.map.find_keyframe(read_keyframe(pick, stored.map));
  const std::optional<MapPosition> place =
      position_at_pixel(stored, keyframe, read_pair(pick, kImagePixel[1], kImagePixel[2]));
  if (!place) pick.fail("has a pixel without a map point nearby", "add a row with its pixel in another keyframe");
  return *place;
}

KeyframePixel read_keyframe_pixel(const Pick& pick, const StoredMap& stored, std::string_view u, std::string_view v) {
  const KeyframeId keyframe = read_keyframe(pick, stored.map);
  const auto pixel = rectified_pixel(stored, *stored.map.find_keyframe(keyframe), read_pair(pick, u, v));
  if (!pixel) pick.fail("has a pixel outside the rectified image", "pick another pixel");
  return {keyframe, *pixel};
}

MapPosition read_position(const Pick& pick, double scale) {
  const Columns columns = pick.has(kPosition) ? kPosition : kPositionOfPoint;
  return {scale * Eigen::Vector3d(pick.number(columns[0]), pick.number(columns[1]), pick.number(columns[2]))};
}

MapPosition read_place_in_map(const Pick& pick, const StoredMap& stored, double positions_scale) {
  pick.require_one({kPoint, kPosition, kPositionOfPoint, kBody, kImagePixel}, "its position in the map",
                   "fill in point, or map_x_m to map_z_m, or time_s, or time_ns, u_px and v_px");
  if (pick.has(kPoint)) return read_point(pick, stored);
  if (pick.has(kBody)) return read_body(pick, stored);
  if (pick.has(kImagePixel)) return read_image_pixel(pick, stored);
  return read_position(pick, positions_scale);
}

double read_sigma(const Pick& pick, const PickOptions& options) {
  if (!pick.has(kSigma)) return options.sigma;
  const double sigma = pick.number(kSigma[0]);
  if (!(sigma > 0.0)) pick.fail("has a non-positive sigma_m", "give the standard deviation of the pick in metres");
  return sigma;
}

// A pick in the pictures of several keyframes: the first row has the position on the plan.
PlanCorrespondence read_triangulated(std::span<const Pick> rows, const FloorPlan& plan, const StoredMap& stored,
                                     const PickOptions& options) {
  const Pick& first = rows.front();
  std::vector<KeyframePixel> pixels;
  for (const Pick& row : rows) pixels.push_back(read_keyframe_pixel(row, stored, kImagePixel[1], kImagePixel[2]));
  const std::optional<TriangulatedPoint> point = triangulate_pixels(stored.map, pixels);
  if (!point) first.fail("is seen from too similar directions", "pick it in keyframes that are farther apart");
  if (!point->is_same_place) {
    first.fail(fmt::format("has pixels of different places: errors of {:.1f} sigmas", point->error),
               "pick the same place in each image");
  }
  return correspondence(first.name(), point->position, read_point_in_plan(first, plan), read_sigma(first, options));
}

PlanCorrespondence read_wall(const Pick& pick, const FloorPlan& plan, const StoredMap& stored,
                             const PickOptions& options) {
  const DrivingPlane driven = require_driving_plane(stored.map, up_of_base(stored), "map");
  const auto foot = [&](std::string_view u, std::string_view v) {
    const auto found = floor_at_pixel(stored.map, read_keyframe_pixel(pick, stored, u, v), driven, options.body_height);
    if (!found) pick.fail("has a pixel that shows no floor", "pick the foot of the wall nearer to the camera");
    return *found;
  };
  return wall_correspondence(pick.name(), foot(kImagePixel[1], kImagePixel[2]), foot(kEndPixel[0], kEndPixel[1]),
                             read_point_in_plan(pick, plan), read_pair(pick, kPlanEnd[0], kPlanEnd[1]),
                             read_sigma(pick, options));
}

// rows: the pick, and rows with its pixels in further keyframes.
PlanCorrespondence read_correspondence(std::span<const Pick> rows, const FloorPlan& plan, const StoredMap& stored,
                                       const PickOptions& options) {
  if (rows.size() > 1) return read_triangulated(rows, plan, stored, options);
  const Pick& pick = rows.front();
  if (pick.has(kEndPixel) || pick.has(kPlanEnd)) return read_wall(pick, plan, stored, options);
  return correspondence(pick.name(), read_place_in_map(pick, stored, options.positions_scale),
                        read_point_in_plan(pick, plan), read_sigma(pick, options));
}

bool is_further_pixel(const Pick& pick) {
  return pick.has(kImagePixel) && !pick.has(kPlanMetres) && !pick.has(kPlanPixel);
}

}  // namespace

std::vector<PlanCorrespondence> read_plan_correspondences(const std::filesystem::path& path, const FloorPlan& plan,
                                                          const StoredMap& stored, const PickOptions& options) {
  const CsvTable table = read_csv_table(path, all_columns());
  std::vector<PlanCorrespondence> correspondences;
  std::vector<Pick> rows;
  for (const CsvTable::Row& row : table.rows) rows.emplace_back(table, row);
  for (auto first = rows.begin(); first != rows.end();) {
    auto end = std::next(first);
    if (first->has(kImagePixel)) end = std::find_if_not(end, rows.end(), is_further_pixel);
    correspondences.push_back(read_correspondence({first, end}, plan, stored, options));
    first = end;
  }
  return correspondences;
}

bool has_positions(const std::filesystem::path& path) {
  const CsvTable table = read_csv_table(path, all_columns());
  return std::ranges::any_of(table.rows, [&table](const CsvTable::Row& row) {
    return Pick(table, row).has(kPosition) || Pick(table, row).has(kPositionOfPoint);
  });
}

}  // namespace byre
