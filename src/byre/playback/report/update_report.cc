#include "byre/playback/report/update_report.h"

#include "byre/geometry/degrees.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>

namespace byre {
namespace {

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

}  // namespace

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

}  // namespace byre
