#pragma once

#include "byre/map/plan/floor_plan.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace byre {

// Reasons to reject a scale measured on a plan.
enum class PlanScaleDoubt : std::uint8_t {
  few_points,    // fewer than four correspondences used: an outlier would not show
  small_spread,  // the correspondences are too close together, or too inaccurate, for 1 %
  // The residuals exceed their sigmas, or a large share of the correspondences are outliers.
  disagreement,
  implausible  // beyond any error of a baseline
};
std::string_view to_string(PlanScaleDoubt doubt);  // description with the remedy

// Scale of a metric map measured on a floor plan. The images of a stereo pair do not measure their baseline, and a
// small rotation of one camera changes all depths much like a different baseline.
struct PlanScale {
  double plan_from_map = 1.0;  // metres on the plan per metre in the map
  double sigma = 0.0;          // standard error of the scale's logarithm, from the picks; the plan is assumed exact
  std::optional<PlanScaleDoubt> doubt;

  double excess() const { return 1.0 / plan_from_map - 1.0; }  // relative excess of the map's size: 0.01 is 1 %
  // Whether the difference is significant and there is no doubt.
  bool differs_from_one() const;
};

// Uses a separate fit with free scale. Empty if register_on_plan fails.
std::optional<PlanScale> measure_scale(std::span<const PlanCorrespondence> correspondences, const DrivingPlane& plane,
                                       const PlanRegistrationOptions& options = {});

}  // namespace byre
