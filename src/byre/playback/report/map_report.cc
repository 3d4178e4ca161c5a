#include "byre/playback/report/map_report.h"

#include "byre/geometry/degrees.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

namespace byre {
namespace {

nlohmann::ordered_json quality_json(const MapQuality& quality) {
  return {{"keyframes", quality.keyframes},
          {"points", quality.points},
          {"observations", quality.observations},
          {"reprojection_median_px", quality.reprojection_median},
          {"reprojection_p95_px", quality.reprojection_p95},
          {"parts", quality.parts}};
}

using Json = nlohmann::ordered_json;

Json place_json(const PlaceProof& place) {
  return {{"centre_m", list_json(place.centre_in_map)},
          {"frames", place.frames},
          {"found_before", place.found_before},
          {"found_after", place.found_after},
          {"inliers_before", place.inliers_before},
          {"inliers_after", place.inliers_after},
          {"shift_mm", 1e3 * place.shift},
          {"shift_sigma_mm", 1e3 * place.shift_sigma},
          {"turn_deg", place.turn / kDegree},
          {"turn_sigma_deg", place.turn_sigma / kDegree},
          {"fault", place.fault.empty() ? Json() : Json(place.fault)}};
}

int found_after(const std::vector<PlaceProof>& places) {
  int found = 0;
  for (const PlaceProof& place : places) found += place.found_after;
  return found;
}

Json session_json(const SessionUse& use) {
  Json session = {{"name", use.name},
                  {"fault", use.place.fault.empty() ? Json() : Json(use.place.fault)},
                  {"keyframes", use.place.frames},
                  {"keyframes_found", use.place.found},
                  {"keyframes_elsewhere", use.place.elsewhere},
                  {"keyframes_found_before", use.place.found - use.place.elsewhere},
                  {"keyframes_found_after", use.places.empty() ? Json() : Json(found_after(use.places))},
                  {"brightness", use.image.brightness},
                  {"noise", use.image.noise},
                  {"counts_misses", use.has_records},
                  {"keyframes_added", use.keyframes_added},
                  {"points_added", use.points_added},
                  {"places", Json::array()}};
  for (const PlaceProof& place : use.places) session["places"].push_back(place_json(place));
  return session;
}

// Sums over places, and the greatest changes of poses.
Json proof_json(const std::vector<PlaceProof>& places) {
  PlaceProof sum;
  for (const PlaceProof& place : places) {
    sum.frames += place.frames;
    sum.found_before += place.found_before;
    sum.found_after += place.found_after;
    sum.inliers_before += place.inliers_before;
    sum.inliers_after += place.inliers_after;
    sum.shift = std::max(sum.shift, place.shift);
    sum.turn = std::max(sum.turn, place.turn);
    sum.shift_sigma = std::max(sum.shift_sigma, place.shift_sigma);
    sum.turn_sigma = std::max(sum.turn_sigma, place.turn_sigma);
  }
  Json proof = place_json(sum);
  proof.erase("centre_m");
  proof.erase("fault");
  proof["places"] = Json::array();
  for (const PlaceProof& place : places) proof["places"].push_back(place_json(place));
  return proof;
}

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

Report finish_report(const FinishResult& finishing) {
  const FinishReport& finish = finishing.report;
  Report report{{{"loops", finish.loops},
                 {"loop_drifts_px", finish.loop_drifts},
                 {"loop_residuals_m", finish.loop_residuals},
                 {"keyframes_removed", finish.keyframes_removed},
                 {"points_removed", finish.points_removed},
                 {"before", quality_json(finish.before)},
                 {"after", quality_json(finish.after)},
                 {"faults", finishing.faults},
                 {"cut_short", finishing.cut_short},
                 {"wall_s", finishing.seconds}}};
  report.detail("last loops",
                "[{?loops}{loops} closed; drift {loop_drifts_px:.1f} px, residual {loop_residuals_m:.3f} m|none]");
  report.detail("removed", "{keyframes_removed} redundant keyframes, {points_removed} weak points");
  report.detail("pixel error",
                "median {before.reprojection_median_px:.3f} -> {after.reprojection_median_px:.3f} px, "
                "95 % within {before.reprojection_p95_px:.3f} -> {after.reprojection_p95_px:.3f} px");
  report.detail("parts", "{before.parts} -> {after.parts} without common points");
  report.row("faults", "{?faults}{#faults}; the first: {faults.0}");
  report.row("finishing", "{?cut_short}interrupted after {wall_s:.1f} s; continue with \"byre refine\"");
  report.detail("finishing", "{!cut_short}{wall_s:.1f} s");
  return report;
}

Report update_report(const MapUpdate& update, const UpdateProtocol& protocol) {
  Json sessions = Json::array();
  int keyframes = 0, points = 0;
  for (const SessionUse& use : update.sessions) {
    sessions.push_back(session_json(use));
    keyframes += use.keyframes_added;
    points += use.points_added;
  }
  Report report{{{"program", "byre update"},
                 {"version", BYRE_VERSION},
                 {"map", protocol.map},
                 {"keyframes", protocol.keyframes},
                 {"points", protocol.points},
                 {"sessions", sessions},
                 {"keyframes_added", keyframes},
                 {"points_added", points},
                 {"points_retired", update.points_retired},
                 {"keyframes_removed", update.keyframes_removed},
                 {"places_spared", update.places_spared},
                 {"proof", proof_json(update.places)},
                 {"refusal", update.child ? Json() : Json(update.refusal)},
                 {"written", update.child ? Json(protocol.written) : Json()}}};
  report.row("map", "{map}: {keyframes} keyframes, {points} points");
  for (const SessionUse& use : update.sessions) {
    report.row(
        "session",
        "{name}: [{?fault}not used, it {fault}|{keyframes_found_before}[ -> {keyframes_found_after}] of {keyframes} "
        "keyframes found at their poses, {keyframes_added} keyframes and {points_added} points added; image "
        "brightness {brightness:.0f}, noise {noise:.1f}"
        "[{!counts_misses}; misses do not count, as it ran on an earlier version]]",
        session_json(use));
  }
  if (!update.places.empty()) {
    report.row("added", "{keyframes_added} keyframes, {points_added} points");
    report.row(
        "retired",
        "{points_retired} points that missions no longer see[{?keyframes_removed}, {keyframes_removed} keyframes]");
    report.row("proof",
               "{#proof.places} places, {proof.frames} frames: {proof.found_before} -> {proof.found_after} found, "
               "{proof.inliers_before} -> {proof.inliers_after} points fit, poses within {proof.shift_mm:.1f} mm and "
               "{proof.turn_deg:.3f} degrees");
  }
  report.row("unchanged", "{?places_spared}around {places_spared} places, which a first attempt made worse");
  for (const PlaceProof& place : update.places) {
    if (!place.fault.empty())
      report.row("worse", "at {centre_m.0:.1f}, {centre_m.1:.1f}, {centre_m.2:.1f} m: {fault}", place_json(place));
  }
  report.row("written", "{written}");
  report.conclude(
      "[{?written}No place is worse than before. Changes: byre view {written} --before {map}. Next: byre run RECORDING "
      "--map {written}|"
      "{map} stays as it is: {refusal}. Next: byre run RECORDING --map {map} --save-session SESSION]");
  return report;
}

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
