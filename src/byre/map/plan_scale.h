#pragma once

#include "byre/map/floor_plan.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace byre {

// Why a scale that was measured on a plan is not to be relied on.
enum class PlanScaleDoubt : std::uint8_t {
  few_points,    // fewer than four correspondences took part: one that is wrong would not show
  small_spread,  // the correspondences lie too close together, or are too rough, to tell a percent
  // The correspondences are farther off than their sigmas explain, or a large part of them is wrong.
  disagreement,
  implausible  // no baseline is as wrong as that
};
std::string_view to_string(PlanScaleDoubt doubt);  // what is the matter, and its remedy

// How long a metric map is, measured on a floor plan. The length of a stereo pair's baseline is not seen by its images,
// and a small turn of one camera changes all depths much like another baseline.
struct PlanScale {
  double plan_from_map = 1.0;  // metres on the plan of a metre in the map
  double sigma = 0.0;          // standard error of the scale's logarithm by the picks; the plan is taken to be true
  std::optional<PlanScaleDoubt> doubt;

  double excess() const { return 1.0 / plan_from_map - 1.0; }  // by how much the map is too large: 0.01 is a percent
  // Whether it differs by more than its uncertainty explains, and beyond doubt.
  bool differs_from_one() const;
};

// From a fit of its own, in which the scale is free. Empty where register_on_plan finds nothing.
std::optional<PlanScale> measure_scale(std::span<const PlanCorrespondence> correspondences, const DrivingPlane& plane,
                                       const PlanRegistrationOptions& options = {});

}  // namespace byre
