#pragma once

#include "byre/simulation/camera_imperfection.h"

#include <optional>

namespace CLI {
class App;
}

namespace byre::cli {

// Imperfections of a simulated camera: a condition, and differences from it.
struct ImperfectionOptions {
  std::optional<CameraCondition> condition{};  // empty: a perfect camera
  std::optional<double> calibration_level{};
  std::optional<std::uint64_t> calibration_seed{};
  std::optional<double> rolling_shutter_ms{};
  std::optional<double> time_offset_ms{};
  std::optional<double> lens_blur{};
  std::optional<double> gain{};
  std::optional<double> offset{};
  std::optional<double> vignetting{};
  std::optional<int> jpeg_quality{};
};

// --imperfection, --calibration-level and so on. The options must outlive the parsing of the command line.
void declare_imperfection(CLI::App& command, ImperfectionOptions& options);

CameraImperfection make_imperfection(const ImperfectionOptions& options);

}  // namespace byre::cli
