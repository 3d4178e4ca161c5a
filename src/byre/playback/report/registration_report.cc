#include "byre/playback/report/registration_report.h"

#include "byre/base/report_row.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

Eigen::Matrix3d rotation_of(const PlanRegistration& registration) {
  return registration.plan_from_map.target_from_source.rotation.toRotationMatrix();
}

std::string describe_plan(const FloorPlan& plan) {
  const double pixel = 1e3 * plan.metres_per_pixel.col(0).norm();
  return plan.name + fmt::format(", {} x {} pixels of {:.1f} mm", plan.width, plan.height, pixel);
}

std::string describe_agreement(const Registering& registering) {
  const auto outliers = std::ranges::count(registering.fit.residuals, true, &PlanResidual::is_outlier);
  const auto count = static_cast<std::ptrdiff_t>(registering.correspondences.size());
  return fmt::format("{}; {} inliers, RMSE {:.3f} m", count, count - outliers, registering.fit.rms);
}

std::string residual_row(const PlanCorrespondence& correspondence, const PlanResidual& residual) {
  const Eigen::Vector2d& error = residual.error_in_plan;
  return row(
      residual.is_outlier ? "outlier" : "fits",
      correspondence.name + fmt::format(": error {:.3f} m (x {:+.3f}, y {:+.3f})", error.norm(), error.x(), error.y()));
}

std::string describe_turn(const PlanRegistration& registration) {
  const Eigen::Matrix3d rotation = rotation_of(registration);
  const double heading = kDegreesPerRadian * std::atan2(rotation(1, 0), rotation(0, 0));
  return fmt::format(
      "x axis of the map at {:.3f} deg on the plan, anticlockwise; vertical ({:.4f}, {:.4f}, {:.4f}) in the map",
      heading, rotation(2, 0), rotation(2, 1), rotation(2, 2));
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

Json correspondence_json(const PlanCorrespondence& correspondence, const PlanResidual& residual) {
  const Eigen::Vector3d& in_map = correspondence.point_in_map;
  const Eigen::Vector2d& in_plan = correspondence.point_in_plan;
  return {{"name", correspondence.name},
          {"point_in_map", {in_map.x(), in_map.y(), in_map.z()}},
          {"point_in_plan_m", {in_plan.x(), in_plan.y()}},
          {"sigma_m", correspondence.sigma},
          {"error_in_plan_m", {residual.error_in_plan.x(), residual.error_in_plan.y()}},
          {"outlier", residual.is_outlier}};
}

}  // namespace

std::string to_text(const Registering& registering, const RegisterProtocol& protocol) {
  const PlanRegistration& registration = registering.fit.registration;
  std::string text = row("map", protocol.map) + row("plan", describe_plan(protocol.plan));
  text += row("points", describe_agreement(registering));
  for (std::size_t i = 0; i < registering.correspondences.size(); ++i) {
    text += residual_row(registering.correspondences[i], registering.fit.residuals[i]);
  }
  text += row("origin", describe_origin(registration)) + row("turn", describe_turn(registration));
  if (registration.covariance(6, 6) > 0.0) {
    text += row("scale", fmt::format("{:.6g} m per unit of the map, sigma {:.2f} %", registration.plan_from_map.scale,
                                     1e2 * std::sqrt(registration.covariance(6, 6))));
  }
  if (const std::optional<PlanScale>& measured = registering.measured_scale) {
    text += row("scale", protocol.scaled_by ? describe_corrected_scale(*measured, *protocol.scaled_by)
                                            : describe_measured_scale(*measured, registering.has_baseline));
  }
  text += row("accuracy", fmt::format("{:.3f} m along the path, {:.3f} deg in yaw (one sigma)",
                                      registering.largest_path_sigma, yaw_sigma(registration)));
  for (const PlanDoubt doubt : registering.fit.doubts) text += row("doubt", std::string(to_string(doubt)));
  if (!protocol.written.empty()) text += row("written", protocol.written);
  return text;
}

std::string to_json(const Registering& registering, const RegisterProtocol& protocol) {
  Json json = {{"program", "byre register"}, {"version", BYRE_VERSION}, {"map", protocol.map}};
  json["registration"] = registration_json(registering.fit.registration);
  json["rms_m"] = registering.fit.rms;
  json["residual_m"] = residual_of(registering.fit);
  json["largest_path_sigma_m"] = registering.largest_path_sigma;
  json["yaw_sigma_deg"] = yaw_sigma(registering.fit.registration);
  const std::optional<PlanScale>& measured = registering.measured_scale;
  json["measured_scale"] = measured ? measured_scale_json(*measured) : Json();
  json["scaled_by"] = protocol.scaled_by ? Json(*protocol.scaled_by) : Json();
  json["doubts"] = Json::array();
  for (const PlanDoubt doubt : registering.fit.doubts) json["doubts"].push_back(to_string(doubt));
  json["points"] = Json::array();
  for (std::size_t i = 0; i < registering.correspondences.size(); ++i) {
    json["points"].push_back(correspondence_json(registering.correspondences[i], registering.fit.residuals[i]));
  }
  json["written"] = protocol.written.empty() ? Json() : Json(protocol.written);
  return dump_json(json, 2) + "\n";
}

}  // namespace byre
