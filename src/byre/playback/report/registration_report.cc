#include "byre/playback/report/registration_report.h"

#include "byre/playback/report/report_json.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

Eigen::Matrix3d rotation_of(const PlanRegistration& registration) {
  return registration.plan_from_map.target_from_source.rotation.toRotationMatrix();
}

// Heading of the map's x axis on the plan, and the vertical in the map.
Json turn_json(const PlanRegistration& registration) {
  const Eigen::Matrix3d rotation = rotation_of(registration);
  return {{"heading_deg", kDegreesPerRadian * std::atan2(rotation(1, 0), rotation(0, 0))},
          {"vertical", list_json(rotation.row(2).transpose())}};
}

double yaw_sigma(const PlanRegistration& registration) {
  const Eigen::Vector3d up_in_map = rotation_of(registration).row(2).transpose();
  return kDegreesPerRadian * std::sqrt(up_in_map.dot(registration.covariance.block<3, 3>(3, 3) * up_in_map));
}

// "1.60 % +- 0.10 % too large"
std::string describe_excess(const PlanScale& scale) {
  return fmt::format("{:.2f} % +- {:.2f} % too {}", 1e2 * std::abs(scale.excess()), 1e2 * scale.sigma,
                     scale.excess() > 0.0 ? "large" : "small");
}

std::string describe_measured_scale(const PlanScale& scale, bool has_baseline) {
  if (scale.doubt) return "not checked: " + std::string(to_string(*scale.doubt));
  if (!scale.differs_from_one()) return "agrees with the plan: " + describe_excess(scale);
  return "the map is " + describe_excess(scale) + (has_baseline ? ": correct it with --fix-scale" : " for the plan");
}

std::string describe_corrected_scale(const PlanScale& scale, double factor) {
  if (factor == 1.0) return "no correction needed: " + describe_excess(scale);
  return "the map was " + describe_excess(scale) + fmt::format(": lengths and baseline are scaled by {:.6g}", factor);
}

Json measured_scale_json(const PlanScale& scale) {
  return {{"plan_from_map", scale.plan_from_map},
          {"sigma", scale.sigma},
          {"too_large_percent", 1e2 * scale.excess()},
          {"differs", scale.differs_from_one()},
          {"doubt", scale.doubt ? Json(to_string(*scale.doubt)) : Json()}};
}

Json match_json(const PlanMatch& match) {
  return {{"explained", match.explained},
          {"margin", match.rival.margin},
          {"rival_shift_m", list_json(match.rival.shift)},
          {"rival_turn_deg", kDegreesPerRadian * match.rival.turn}};
}

Json correspondence_json(const PlanCorrespondence& correspondence, const PlanResidual& residual) {
  return {{"name", correspondence.name},
          {"point_in_map", list_json(correspondence.point_in_map)},
          {"point_in_plan_m", list_json(correspondence.point_in_plan)},
          {"wall", correspondence.wall.has_value()},
          {"sigma_m", residual.sigma},
          {"error_in_plan_m", list_json(residual.error_in_plan)},
          {"outlier", residual.is_outlier}};
}

}  // namespace

Report registration_report(const Registering& registering, const RegisterProtocol& protocol) {
  const PlanRegistration& registration = registering.fit.registration;
  const std::optional<PlanScale>& measured = registering.measured_scale;
  const std::optional<PlanMatch>& match = registering.match;
  Report report{{{"program", "byre register"},
                 {"version", BYRE_VERSION},
                 {"map", protocol.map},
                 {"registration", registration_json(registration)},
                 {"rms_m", registering.fit.rms},
                 {"residual_m", residual_of(registering.fit)},
                 {"largest_path_sigma_m", registering.largest_path_sigma},
                 {"yaw_sigma_deg", yaw_sigma(registration)},
                 {"measured_scale", measured ? measured_scale_json(*measured) : Json()},
                 {"scaled_by", or_null(protocol.scaled_by)},
                 {"match", match ? match_json(*match) : Json()},
                 {"doubts", Json::array()},
                 {"points", Json::array()},
                 {"written", protocol.written.empty() ? Json() : Json(protocol.written)}}};
  report.row("map", "{map}");
  report.row("plan", "{name}, {width} x {height} pixels of {pixel_mm:.1f} mm",
             {{"name", protocol.plan.name},
              {"width", protocol.plan.width},
              {"height", protocol.plan.height},
              {"pixel_mm", 1e3 * protocol.plan.metres_per_pixel.col(0).norm()}});
  if (match) report.row("walls", "{match}", {{"match", describe_match(*match)}});
  report.row("points", "{count}; {inliers} inliers, RMSE {rms_m:.3f} m",
             {{"count", registering.fit.residuals.size()},
              {"inliers", std::ranges::count(registering.fit.residuals, false, &PlanResidual::is_outlier)}});
  for (std::size_t i = 0; i < registering.correspondences.size(); ++i) {
    const PlanResidual& residual = registering.fit.residuals[i];
    Json point = correspondence_json(registering.correspondences[i], residual);
    report.figures["points"].push_back(point);
    point["error_m"] = residual.error_in_plan.norm();
    report.row(residual.is_outlier ? "outlier" : "fits",
               "{name}: error {error_m:.3f} m (x {error_in_plan_m.0:+.3f}, y {error_in_plan_m.1:+.3f})", point);
  }
  report.row("origin", "{origin}", {{"origin", describe_origin(registration)}});
  report.row(
      "turn",
      "x axis of the map at {heading_deg:.3f} deg on the plan, anticlockwise; vertical ({vertical:.4f}) in the map",
      turn_json(registration));
  report.row("scale", "{?sigma}{registration.scale:.6g} m per unit of the map, sigma {sigma*100:.2f} %",
             {{"sigma", std::sqrt(std::max(0.0, registration.covariance(6, 6)))}});
  if (measured) {
    report.row("scale", "{scale}",
               {{"scale", protocol.scaled_by ? describe_corrected_scale(*measured, *protocol.scaled_by)
                                             : describe_measured_scale(*measured, registering.has_baseline)}});
  }
  report.row("accuracy", "{largest_path_sigma_m:.3f} m along the path, {yaw_sigma_deg:.3f} deg in yaw (one sigma)");
  for (const PlanDoubt doubt : registering.fit.doubts) {
    report.figures["doubts"].push_back(to_string(doubt));
    report.row("doubt", "{doubt}", {{"doubt", to_string(doubt)}});
  }
  report.row("written", "{written}");
  report.conclude(
      "Fits the plan within {residual_m:.3f} m[{?doubts}, with doubts]"
      "[{?written}. Next: byre run RECORDING --map {written}, whose poses are on the plan"
      "|; no map is saved. Next: [{!match}correct the points, or ]save it with -o MAP.byre]");
  return report;
}

}  // namespace byre
