#include "byre/playback/report/calibration_report.h"

#include "byre/base/report_row.h"
#include "byre/features/stereo_quality.h"

#include <cmath>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

// A parameter in its own unit.
struct Row {
  const CalibrationParameter& parameter;
  double change = 0.0;
  double sigma_before = 0.0;
  double sigma_after = 0.0;

  // Refinement at least halved its standard error.
  bool is_determined() const { return sigma_after < 0.5 * sigma_before; }
  // Refinement changed it by more than a twentieth of its standard error before.
  bool is_changed() const { return std::abs(change) > 0.05 * sigma_before; }
};

std::vector<Row> rows_of(const RefinedCalibration& refined) {
  std::vector<Row> rows;
  for (int i = 0; i < kCalibrationParameters; ++i) {
    if (!has_parameter(refined.calibration, i)) continue;
    const CalibrationParameter& parameter = calibration_parameters()[static_cast<std::size_t>(i)];
    rows.push_back({parameter, parameter.sigma * refined.change[i], parameter.sigma * refined.sigma_before[i],
                    parameter.sigma * refined.sigma_after[i]});
  }
  return rows;
}

std::string names_of_changed(const std::vector<Row>& rows) {
  std::string names;
  for (const Row& row : rows) {
    if (row.is_changed()) names += (names.empty() ? "" : ", ") + std::string(row.parameter.name);
  }
  return names;
}

std::string describe_optics(const RefinedCalibration& refined) {
  if (refined.keyframes == 0) return "as given, except for baseline length or readout time";
  if (refined.was_refused()) {
    return fmt::format("as given; refinement from {} keyframes rejected: change of {:.2f} px", refined.keyframes,
                       refined.shift);
  }
  if (refined.change.isZero(0.0)) return fmt::format("as given, confirmed by {} keyframes", refined.keyframes);
  const std::string changed = names_of_changed(rows_of(refined));
  return fmt::format("refined from {} keyframes, by {:.2f} px (root mean square)", refined.keyframes, refined.shift) +
         (changed.empty() ? "" : ": " + changed);
}

}  // namespace

std::string describe_calibration(const RefinedCalibration& refined) {
  constexpr double kMilliseconds = 1e3;
  const double readout_time = refined.calibration.readout_time;
  return describe_optics(refined) +
         (readout_time == 0.0 ? ""
                              : fmt::format("; rolling shutter, readout time {:.1f} ms", kMilliseconds * readout_time));
}

std::string calibration_row(const std::optional<RefinedCalibration>& refined, const std::optional<double>& row_error) {
  if (!refined) return "";
  const std::string by_rows =
      row_error ? fmt::format("error about {:.2f} px (row differences of the pair); ", *row_error) : "";
  return row("calibration", by_rows + describe_calibration(*refined));
}

std::string calibration_table(const RefinedCalibration& refined) {
  std::string text;
  if (refined.keyframes == 0) return text;
  for (const Row& row : rows_of(refined)) {
    text += fmt::format("  {:28} {:+11.5f} {:3}  sigma {:.5f} before, {:.5f} now{}\n", std::string(row.parameter.name),
                        row.change, std::string(row.parameter.unit), row.sigma_before, row.sigma_after,
                        row.is_changed() ? "" : " (as given)");
  }
  return text;
}

std::optional<std::string> calibration_warning(const std::optional<RefinedCalibration>& refined,
                                               const std::optional<double>& row_error) {
  if (refined && refined->is_implausible()) {
    return fmt::format(
        "the calibration is not of these cameras: refinement from {} keyframes would change it by {:.2f} px, more than "
        "plausible calibration errors; it is used unchanged. Check resolution and focal length, and calibrate the "
        "cameras again",
        refined->keyframes, refined->shift);
  }
  if (!row_error || *row_error <= kMaxCommonRowError) return std::nullopt;
  const bool is_refined = refined && !refined->was_refused();
  return fmt::format("the calibration has an error of about {:.2f} px (row differences of the pair): ", *row_error) +
         (is_refined ? "calibrate the cameras again, or use a calibration by \"byre calibrate\""
                     : "calibrate the cameras again");
}

nlohmann::ordered_json calibration_json(const RefinedCalibration& refined) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
  for (const Row& row : rows_of(refined)) {
    parameters.push_back({{"name", row.parameter.name},
                          {"unit", row.parameter.unit},
                          {"change", row.change},
                          {"sigma_before", row.sigma_before},
                          {"sigma_after", row.sigma_after},
                          {"determined", row.is_determined()}});
  }
  return {{"readout_time_s", refined.calibration.readout_time},
          {"keyframes", refined.keyframes},
          {"observations", refined.observations},
          {"shift_px", refined.shift},
          {"refused", refined.was_refused()},
          {"parameters", parameters}};
}

}  // namespace byre
