#include "byre/playback/archive/register_map.h"

#include "byre/base/csv_table.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/map/plan/driving_plane.h"
#include "byre/map/scaled_copy.h"
#include "byre/map/stored_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>

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

double largest_sigma(const PlanRegistration& registration, const std::vector<Eigen::Vector3d>& path_in_map) {
  double largest = 0.0;
  for (const Eigen::Vector3d& position : path_in_map) {
    largest = std::max(largest, plan_covariance_at(registration, position).trace());
  }
  return std::sqrt(largest);
}

bool is_stereo(const StoredMap& stored) {
  return std::ranges::any_of(stored.map.rigs(), &Rig::is_stereo);
}

bool has_scale_of_baseline(const StoredMap& stored) {
  return stored.scale == MapScale::metric && stored.pose_source == PoseSource::slam && is_stereo(stored);
}

void require_scale_of_baseline(const StoredMap& stored, const std::string& map) {
  if (has_scale_of_baseline(stored)) return;
  if (stored.scale != MapScale::metric) {
    throw InputError(map, "has no metric scale to correct",
                     "omit --fix-scale, and the scale is estimated; or set it with byre scale");
  }
  if (!is_stereo(stored)) {
    throw InputError(map, "was made by one camera, so it has no baseline to correct",
                     "use byre scale with a known distance");
  }
  throw InputError(map, "has the scale of given poses, not of a baseline",
                   "correct the scale of the given poses, and make the map again");
}

void require_scale_known(const PlanScale& scale, const std::string& picks) {
  if (!scale.doubt) return;
  throw InputError(picks, "does not determine the scale: " + std::string(to_string(*scale.doubt)),
                   "without --fix-scale the map keeps its scale");
}

// Positions refer to the map in which they were picked. After an earlier correction it is ambiguous which map that is.
void require_unambiguous(const StoredMap& stored, const std::filesystem::path& picks) {
  if (picks.empty() || !has_positions(picks)) return;
  for (std::size_t i = 0; i < stored.recordings.size(); ++i) {
    const double factor = baseline_factor(stored, i);
    if (factor == 1.0) continue;
    throw InputError(picks.string(),
                     fmt::format("gives positions, but the map has been scaled by {:.6g} since it was made: they may "
                                 "refer to the map before scaling",
                                 factor),
                     "give points, times or pixels of the map");
  }
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

Registering register_map(const StoredMap& stored, const std::filesystem::path& map, const FloorPlan& plan,
                         const std::filesystem::path& picks, const RegisterOptions& options) {
  const DrivingPlane plane = require_driving_plane(stored.map, up_of_base(stored), map.string());
  Registering result;
  PickOptions of_picks = options.picks;
  of_picks.body_height = options.registration.body_height;
  if (!picks.empty()) result.correspondences = read_plan_correspondences(picks, plan, stored, of_picks);
  const std::vector<PlanCorrespondence> of_tags = tag_correspondences(stored, options.tags);
  result.correspondences.insert(result.correspondences.end(), of_tags.begin(), of_tags.end());
  const Scale scale = stored.scale == MapScale::metric ? Scale::fixed : Scale::free;
  std::optional<PlanFit> fit = register_on_plan(result.correspondences, plane, scale, options.registration);
  if (!fit) {
    if (picks.empty()) {
      throw InputError(map.string(), "has too few of the surveyed tags to be registered on the plan",
                       "survey two or more distant tags of the map, or pick points (--points)");
    }
    throw InputError(picks.string(), "needs two distant points to register the map on the plan",
                     "pick three or more distant points");
  }
  result.fit = std::move(*fit);
  result.fit.registration.plan = plan.name;
  result.largest_path_sigma = largest_sigma(result.fit.registration, plane.path_in_map);
  if (scale == Scale::fixed) result.measured_scale = measure_scale(result.correspondences, plane, options.registration);
  result.has_baseline = has_scale_of_baseline(stored);
  return result;
}

Registering register_by_walls(const StoredMap& stored, const std::filesystem::path& map, const DrawnFloorPlan& plan,
                              std::optional<double> body_height) {
  const std::string remedy = "pick points of the map and the plan: byre view MAP --plan PLAN";
  if (stored.scale != MapScale::metric) throw InputError(map.string(), "has no metric scale to match a plan", remedy);
  const DrivingPlane plane = require_driving_plane(stored.map, up_of_base(stored), map.string());
  std::optional<PlanMatch> match = match_with_plan(stored.map, plane, plan, body_height);
  if (!match) throw InputError(map.string(), "has no obstacles to match, or the plan has no walls", remedy);
  if (match->doubt) {
    throw InputError(map.string(), "is not registered: " + describe_match(*match),
                     std::string(to_string(*match->doubt)));
  }
  Registering result;
  result.fit = match->fit;
  result.largest_path_sigma = largest_sigma(result.fit.registration, plane.path_in_map);
  result.has_baseline = has_scale_of_baseline(stored);
  result.match = std::move(match);
  return result;
}

ScaleCorrectedMap correct_scale(StoredMap stored, const std::filesystem::path& map, const FloorPlan& plan,
                                const std::filesystem::path& picks, const RegisterOptions& options) {
  require_scale_of_baseline(stored, map.string());
  ScaleCorrectedMap corrected{std::move(stored), {}, 1.0};
  corrected.registering = register_map(corrected.stored, map, plan, picks, options);
  const PlanScale measured = corrected.registering.measured_scale.value();
  require_scale_known(measured, picks.empty() ? map.string() : picks.string());
  if (!measured.differs_from_one()) return corrected;

  require_unambiguous(corrected.stored, picks);
  corrected.factor = measured.plan_from_map;
  corrected.stored = scaled_copy(corrected.stored, corrected.factor);
  RegisterOptions of_scaled = options;
  of_scaled.picks.positions_scale *= corrected.factor;
  corrected.registering = register_map(corrected.stored, map, plan, picks, of_scaled);
  corrected.registering.measured_scale = measured;
  return corrected;
}

std::string describe_origin(const PlanRegistration& registration) {
  const Eigen::Vector3d& origin = registration.plan_from_map.target_from_source.translation;
  return registration.plan + fmt::format(": the map's origin is at x {:.3f}, y {:.3f}, {:.3f} m above its floor",
                                         origin.x(), origin.y(), origin.z());
}

}  // namespace byre
