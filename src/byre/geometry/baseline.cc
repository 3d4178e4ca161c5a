#include "byre/geometry/baseline.h"

#include "byre/input_error.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

namespace byre {
namespace {

bool is_usual_baseline(double metres) {
  return metres >= kShortestBaseline && metres <= kLongestBaseline;
}

// The baseline in metres if its unit is the first smaller one that gives a usual value; empty without such a unit.
std::optional<double> in_smaller_unit(double number) {
  constexpr std::array<double, 3> kUnits = {0.01, 0.001, 0.0254};  // centimetre, millimetre, inch
  for (const double unit : kUnits) {
    if (number > kLongestBaseline && is_usual_baseline(unit * number)) return unit * number;
  }
  return std::nullopt;
}

}  // namespace

double baseline_of(const Calibration& calibration) {
  return calibration.right ? calibration.right->right_from_left.translation.norm() : 0.0;
}

Calibration with_checked_baseline(Calibration calibration, const std::optional<double>& confirmed,
                                  const std::string& place, const std::string& option) {
  const double baseline = baseline_of(calibration);
  if (confirmed) {
    if (!(*confirmed > 0.0) || !std::isfinite(*confirmed)) {
      throw InputError(place, "has a given baseline that is not a positive number of metres", "see " + option);
    }
    if (!calibration.right) {
      throw InputError(place, "has one camera only, so a baseline does not apply", "omit " + option);
    }
    if (!(baseline > 0.0)) {
      throw InputError(place, "has both cameras at the same position, so the direction of the baseline is unknown",
                       "correct the translation between the cameras");
    }
    calibration.right->right_from_left.translation *= *confirmed / baseline;
    return calibration;
  }
  if (!calibration.right || is_usual_baseline(baseline)) return calibration;
  const auto likely = in_smaller_unit(baseline);
  std::string remedy = "check that the extrinsics are in metres";
  if (likely) remedy += fmt::format("; correct the baseline with {}{:g}", option, *likely);
  if (baseline >= kShortestConfirmed && baseline <= kLongestConfirmed) {
    remedy += fmt::format("{}confirm it with {}{:g}", likely ? ", or " : "; ", option, baseline);
  }
  throw InputError(
      place,
      fmt::format("has a baseline of {:g} m between left and right camera; usual values are {:g} to {:g} m", baseline,
                  kShortestBaseline, kLongestBaseline),
      remedy);
}

}  // namespace byre
