#include "byre/playback/report/recording_check_report.h"

#include "byre/base/report_row.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

std::string describe(const CameraCheck& camera) {
  return fmt::format("brightness {:.0f} and contrast {:.0f} grey values, sharpness {:.2f}; {} of {} images unusable",
                     camera.brightness, camera.contrast, camera.sharpness, camera.unusable(), camera.images);
}

// Whether at least half of the left images have features.
bool has_features(const RecordingCheck& check) {
  return check.features > 0.0;
}

std::string describe(const PairCheck& pair) {
  return fmt::format("{:.0f} % of the features matched in the right image, row error {:.2f} px", 100.0 * pair.matched,
                     pair.row_error);
}

Json to_json(const CameraCheck& camera) {
  Json faults;
  for (std::size_t i = 1; i < camera.by_fault.size(); ++i) {
    faults[std::string(to_string(static_cast<ImageFault>(i)))] = camera.by_fault[i];
  }
  return {{"images", camera.images},
          {"brightness", camera.brightness},
          {"contrast", camera.contrast},
          {"sharpness", camera.sharpness},
          {"of_no_use", faults}};
}

}  // namespace

std::string summary_of(const RecordingCheck& check) {
  std::string text = fmt::format("{:.1f} Hz, {} gaps; {:.0f} features", check.rate_hz, check.gaps, check.features);
  if (!check.pair || !has_features(check)) return text;
  return text + fmt::format(", {:.0f} % matched in both images, row error {:.2f} px", 100.0 * check.pair->matched,
                            check.pair->row_error);
}

std::string describe(const RecordingCheck& check, const std::vector<Finding>& findings) {
  std::string text = row("frames", fmt::format("{} at {:.1f} Hz, {} gaps, the longest {:.2f} s", check.frames,
                                               check.rate_hz, check.gaps, check.longest_gap_s));
  text += row("sampled", fmt::format("{} frames; {} unreadable, {} without a right image, {} repeated", check.sampled,
                                     check.unreadable, check.without_right, check.repeated));
  text += row("left", describe(check.left));
  if (check.right) text += row("right", describe(*check.right));
  if (check.pair && has_features(check)) {
    text += row("pair", describe(*check.pair));
    text += row("calibration",
                fmt::format("error about {:.2f} px (row differences of the pair)", check.pair->calibration_error));
  }
  text += row("features", fmt::format("{:.0f} per image", check.features));
  text += row("view", fmt::format("{:.0f} degrees wide", check.field_of_view_deg));
  if (check.baseline_m > 0.0) text += row("baseline", fmt::format("{:.4f} m", check.baseline_m));
  for (const Finding& finding : findings) {
    text += row(finding.is_critical ? "PROBLEM" : "warning", finding.what) + row("", finding.remedy);
  }
  if (findings.empty()) text += row("found", "no problems");
  return text;
}

Json times_json(const TimeCorrections& times) {
  Json steps = Json::array();
  for (const ClockStep& step : times.clock_steps)
    steps.push_back({{"frame", step.frame}, {"by_s", to_seconds(step.by)}});
  return {{"source", to_string(times.source)},
          {"clock_steps", steps},
          {"late", times.late},
          {"repeated", times.repeated},
          {"unstamped", times.unstamped}};
}

Json check_json(const RecordingCheck& check, const std::vector<Finding>& findings) {
  Json json = {{"frames", check.frames},
               {"rate_hz", check.rate_hz},
               {"gaps", check.gaps},
               {"longest_gap_s", check.longest_gap_s},
               {"looked_at", check.sampled},
               {"unreadable", check.unreadable},
               {"without_right", check.without_right},
               {"repeated", check.repeated},
               {"features", check.features},
               {"field_of_view_deg", check.field_of_view_deg},
               {"baseline_m", check.baseline_m},
               {"times", times_json(check.times)},
               {"left", to_json(check.left)},
               {"right", check.right ? to_json(*check.right) : Json()},
               {"pair", nullptr},
               {"findings", Json::array()}};
  if (check.pair) {
    json["pair"] = {{"pairs", check.pair->pairs},
                    {"matched_percent", 100.0 * check.pair->matched},
                    {"row_error_px", check.pair->row_error},
                    {"calibration_error_px", check.pair->calibration_error}};
  }
  for (const Finding& finding : findings) {
    json["findings"].push_back({{"grave", finding.is_critical}, {"what", finding.what}, {"remedy", finding.remedy}});
  }
  return json;
}

}  // namespace byre
