#include "byre/playback/archive/register_map.h"

#include "byre/input_error.h"
#include "byre/map/scaled_copy.h"
#include "byre/map/stored_calibration.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

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
