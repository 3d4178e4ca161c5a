#include "byre/benchmark/measures.h"

#include "byre/trajectory_error.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace byre {
namespace {

constexpr double kMillimetres = 1e3, kPercent = 1e2, kUnchanged = 1.0;

constexpr auto kTrajectoryMeasures = std::to_array<Measure<TrajectoryMeasures>>({
    {&TrajectoryMeasures::coverage, "coverage", "coverage %", kPercent, 1, true},
    {&TrajectoryMeasures::ate, "ate_m", "ATE mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::ate_max, "ate_max_m", "ATE max mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::map_error, "map_error_m", "map error mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::map_error_median, "map_error_median_m", "median mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::map_error_max, "map_error_max_m", "max mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::rpe_frame, "rpe_1frame_m", "RPE 1 frame mm", kMillimetres, 2, false},
    {&TrajectoryMeasures::rpe_frame_deg, "rpe_1frame_deg", "deg", kUnchanged, 3, false},
    {&TrajectoryMeasures::rpe_second, "rpe_1s_m", "RPE 1 s mm", kMillimetres, 2, false},
    {&TrajectoryMeasures::rpe_second_deg, "rpe_1s_deg", "deg", kUnchanged, 3, false},
    {&TrajectoryMeasures::rpe_metre, "rpe_1m_m", "RPE 1 m mm", kMillimetres, 2, false},
    {&TrajectoryMeasures::rpe_metre_deg, "rpe_1m_deg", "deg", kUnchanged, 3, false},
});

constexpr auto kBehaviourMeasures = std::to_array<Measure<BehaviourMeasures>>({
    {&BehaviourMeasures::first_pose, "first_pose_s", "first pose s", kUnchanged, 2, false},
    {&BehaviourMeasures::losses, "losses", "losses", kUnchanged, 0, false},
    {&BehaviourMeasures::trusted_share, "trusted_share", "trusted %", kPercent, 1, true},
    {&BehaviourMeasures::trusted_map_error_max, "trusted_map_error_max_m", "worst trusted mm", kMillimetres, 1, false},
    {&BehaviourMeasures::wrongly_trusted, "trusted_wrong", "trusted > 0.2 m", kUnchanged, 0, false},
    {&BehaviourMeasures::longest_wrong_trust, "longest_wrong_trust_s", "longest s", kUnchanged, 2, false},
    {&BehaviourMeasures::within_bound, "within_bound", "within 95 % bound %", kPercent, 1, true},
    {&BehaviourMeasures::keyframes, "keyframes", "keyframes", kUnchanged, 0, false},
    {&BehaviourMeasures::keyframe_rate_mapped, "keyframes_per_minute_known", "per minute, known", kUnchanged, 1, false},
    {&BehaviourMeasures::keyframe_rate_unmapped, "keyframes_per_minute_new", "per minute, new", kUnchanged, 1, false},
});

constexpr auto kCostMeasures = std::to_array<Measure<CostMeasures>>({
    {&CostMeasures::frame_ms_mean, "frame_ms_mean", "ms per frame", kUnchanged, 1, false},
    {&CostMeasures::frame_ms_p99, "frame_ms_p99", "p99 ms", kUnchanged, 1, false},
    {&CostMeasures::peak_memory_mb, "peak_memory_mb", "peak memory MB", kUnchanged, 0, false},
    {&CostMeasures::cpu_seconds, "cpu_s", "CPU s", kUnchanged, 1, false},
});

}  // namespace

std::span<const Measure<TrajectoryMeasures>> trajectory_measures() {
  return kTrajectoryMeasures;
}
std::span<const Measure<BehaviourMeasures>> behaviour_measures() {
  return kBehaviourMeasures;
}
std::span<const Measure<CostMeasures>> cost_measures() {
  return kCostMeasures;
}

std::optional<RunSummary> summarise_runs(const std::vector<Figure>& figures, bool more_is_better) {
  std::vector<double> values;
  for (const Figure& figure : figures) {
    if (figure) values.push_back(*figure);
  }
  if (values.empty()) return std::nullopt;
  std::ranges::sort(values);
  const int runs = static_cast<int>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / runs;
  return RunSummary{runs, mean, quantile(values, 0.5), more_is_better ? values.front() : values.back()};
}

}  // namespace byre
