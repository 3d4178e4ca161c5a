#include "mission_score.h"

#include "byre/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace byre {
namespace {

bool is_trusted(const MissionFrame& frame) {
  return frame.report.health.verdict == Verdict::trusted;
}

// True position in the estimated body frame, metres.
Eigen::Vector3d offset_in_body(const Pose& map_from_body, const Pose& true_world_from_body,
                               const Similarity& truth_from_map) {
  const Pose estimated_world_from_body = aligned(truth_from_map, map_from_body);
  return inverse(estimated_world_from_body) * true_world_from_body.translation;
}

bool is_within_bound(const MissionFrame& frame, const Similarity& truth_from_map) {
  constexpr double kChiSquare3 = 7.815;  // 95 % quantile with three degrees of freedom
  const Eigen::Matrix3d covariance = frame.report.covariance.topLeftCorner<3, 3>();
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::Vector3d offset =
      offset_in_body(*frame.report.map_from_body, *frame.true_world_from_body, truth_from_map);
  return offset.dot(factor.solve(offset)) <= kChiSquare3;
}

double share(std::ptrdiff_t count, std::size_t of) {
  return of == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(of);
}

// Share of trusted and degraded poses within the bound of their covariance.
double share_within_bound(std::span<const MissionFrame> frames, const std::optional<Similarity>& truth_from_map) {
  if (!truth_from_map) return 0.0;
  std::ptrdiff_t within = 0;
  std::size_t count = 0;
  for (const MissionFrame& frame : frames) {
    if (!position_error(frame, truth_from_map) || frame.report.health.verdict == Verdict::untrusted) continue;
    ++count;
    within += is_within_bound(frame, *truth_from_map) ? 1 : 0;
  }
  return share(within, count);
}

double root_mean_square(std::span<const MissionFrame> frames, const std::optional<Similarity>& truth_from_map) {
  double sum = 0.0;
  int count = 0;
  for (const MissionFrame& frame : frames) {
    const std::optional<double> error = position_error(frame, truth_from_map);
    if (!error) continue;
    sum += *error * *error;
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(sum / count);
}

double worst_trusted(std::span<const MissionFrame> frames, const std::optional<Similarity>& truth_from_map) {
  double worst = 0.0;
  for (const MissionFrame& frame : frames) {
    if (is_trusted(frame)) worst = std::max(worst, position_error(frame, truth_from_map).value_or(0.0));
  }
  return worst;
}

bool is_wrongly_trusted(const MissionFrame& frame, const std::optional<Similarity>& truth_from_map) {
  return is_trusted(frame) && position_error(frame, truth_from_map).value_or(0.0) > kMaxTrustedError;
}

// A sequence of wrong frames lasts until the next right one.
double longest_wrong_trust(std::span<const MissionFrame> frames, const std::optional<Similarity>& truth_from_map) {
  Timestamp longest{0};
  std::optional<Timestamp> since;
  for (const MissionFrame& frame : frames) {
    const Timestamp now = frame.report.time;
    if (since) longest = std::max(longest, now - *since);
    const bool is_wrong = is_wrongly_trusted(frame, truth_from_map);
    if (!is_wrong) since.reset();
    if (is_wrong && !since) since = now;
  }
  return to_seconds(longest);
}

std::optional<double> recovery_after(std::span<const MissionFrame> frames, Timestamp undisturbed_from) {
  const auto recovered = std::ranges::find_if(
      frames, [&](const MissionFrame& frame) { return frame.report.time >= undisturbed_from && is_trusted(frame); });
  if (recovered == frames.end()) return std::nullopt;
  return to_seconds(recovered->report.time - undisturbed_from);
}

}  // namespace

std::optional<double> time_to_doubt(std::span<const MissionFrame> frames, DistrustReason doubt, Timestamp from) {
  const auto found = std::ranges::find_if(frames, [&](const MissionFrame& frame) {
    return frame.report.time >= from && frame.report.health.doubt == doubt;
  });
  if (found == frames.end()) return std::nullopt;
  const auto posed = std::ranges::find_if(frames, [&](const MissionFrame& frame) {
    return frame.report.time >= from && frame.report.map_from_body.has_value();
  });
  const Timestamp begin = posed == frames.end() ? from : posed->report.time;
  return std::max(0.0, to_seconds(found->report.time - begin));
}

std::optional<double> position_error(const MissionFrame& frame, const std::optional<Similarity>& truth_from_map) {
  if (!frame.report.map_from_body) return std::nullopt;
  if (!truth_from_map) return std::numeric_limits<double>::infinity();
  if (!frame.true_world_from_body) return std::nullopt;
  return offset_in_body(*frame.report.map_from_body, *frame.true_world_from_body, *truth_from_map).norm();
}

MissionScore score(std::span<const MissionFrame> frames, const std::optional<Similarity>& truth_from_map,
                   const std::optional<Timestamp>& undisturbed_from) {
  MissionScore score;
  score.frames = static_cast<int>(frames.size());
  score.coverage = share(
      std::ranges::count_if(frames, [](const MissionFrame& frame) { return frame.report.map_from_body.has_value(); }),
      frames.size());
  score.trusted = share(std::ranges::count_if(frames, is_trusted), frames.size());
  score.wrongly_trusted = static_cast<int>(std::ranges::count_if(
      frames, [&](const MissionFrame& frame) { return is_wrongly_trusted(frame, truth_from_map); }));
  score.worst_trusted_error = worst_trusted(frames, truth_from_map);
  score.longest_wrong_trust = longest_wrong_trust(frames, truth_from_map);
  if (undisturbed_from) score.recovery = recovery_after(frames, *undisturbed_from);
  score.rmse = root_mean_square(frames, truth_from_map);
  score.within_bound = share_within_bound(frames, truth_from_map);
  return score;
}

}  // namespace byre
