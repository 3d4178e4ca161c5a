#include "byre/map/plan/plan_scale.h"

#include "byre/base/enum_names.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

constexpr int kFewest = 4;              // number of correspondences
constexpr double kLargestSigma = 0.01;  // relative
constexpr double kSignificant = 3.0;    // sigmas
constexpr double kLargestChange = 0.1;  // relative

std::optional<PlanScaleDoubt> doubt_about(const PlanFit& fit, const PlanScale& scale) {
  if (std::ranges::count(fit.residuals, false, &PlanResidual::is_outlier) < kFewest) return PlanScaleDoubt::few_points;
  if (std::ranges::count(fit.doubts, PlanDoubt::disagreement) > 0) return PlanScaleDoubt::disagreement;
  if (!(scale.sigma <= kLargestSigma)) return PlanScaleDoubt::small_spread;
  if (std::abs(std::log(scale.plan_from_map)) > kLargestChange) return PlanScaleDoubt::implausible;
  return std::nullopt;
}

}  // namespace

std::string_view to_string(PlanScaleDoubt doubt) {
  return name_among<PlanScaleDoubt::implausible>(
      {"fewer than four correspondences are used, so a wrong one cannot be detected: pick more",
       "the uncertainty of the scale exceeds 1 %: pick more correspondences, farther apart",
       "the correspondences are inconsistent: check them",
       "map and plan differ by more than 10 %, too much for a baseline error: check the resolution of the plan"},
      doubt);
}

bool PlanScale::differs_from_one() const {
  return !doubt && std::abs(std::log(plan_from_map)) > kSignificant * sigma;
}

std::optional<PlanScale> measure_scale(std::span<const PlanCorrespondence> correspondences, const DrivingPlane& plane,
                                       const PlanRegistrationOptions& options) {
  const std::optional<PlanFit> fit = register_on_plan(correspondences, plane, Scale::free, options);
  if (!fit) return std::nullopt;
  PlanScale scale;
  scale.plan_from_map = fit->registration.plan_from_map.scale;
  scale.sigma = std::sqrt(fit->registration.covariance(6, 6));
  scale.doubt = doubt_about(*fit, scale);
  return scale;
}

}  // namespace byre
