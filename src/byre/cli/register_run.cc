#include "byre/cli/register_run.h"

#include "byre/cli/register_picks.h"
#include "byre/input/input_error.h"

#include <algorithm>
#include <cmath>

namespace byre::cli {
namespace {

double largest_sigma(const PlanRegistration& registration, const std::vector<Eigen::Vector3d>& path_in_map) {
  double largest = 0.0;
  for (const Eigen::Vector3d& position : path_in_map) {
    largest = std::max(largest, plan_covariance_at(registration, position).trace());
  }
  return std::sqrt(largest);
}

}  // namespace

Registering register_map(const StoredMap& stored, const std::filesystem::path& map, const FloorPlan& plan,
                         const std::filesystem::path& picks, const RegisterOptions& options) {
  const std::optional<DrivingPlane> plane = fit_driving_plane(stored.map);
  if (!plane) {
    throw InputError(map.string(), "does not tell which way is up: its keyframes are none, or held in all directions",
                     "map a recording of a camera that stays upright");
  }
  Registering result;
  result.correspondences = read_plan_correspondences(picks, plan, stored, options.pick_sigma);
  const Scale scale = stored.scale == MapScale::metric ? Scale::fixed : Scale::free;
  std::optional<PlanFit> fit = register_on_plan(result.correspondences, *plane, scale, options.registration);
  if (!fit) {
    throw InputError(picks.string(), "has not two points that lie apart, so the map cannot be placed on the plan",
                     "pick three or more, far apart");
  }
  result.fit = std::move(*fit);
  result.fit.registration.plan = plan.name;
  result.largest_path_sigma = largest_sigma(result.fit.registration, plane->path_in_map);
  return result;
}

}  // namespace byre::cli
