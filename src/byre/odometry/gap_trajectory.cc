#include "byre/odometry/gap_trajectory.h"

#include <algorithm>
#include <cstddef>

namespace byre {
namespace {

constexpr std::size_t kMaxPendingFrames = 36'000;  // steps: half an hour at 20 Hz
constexpr std::size_t kMostSteps = 100'000;

std::optional<Pose> pose_of_frame(const Trajectory& trajectory, Timestamp time) {
  const auto found = std::ranges::lower_bound(trajectory, time, {}, &StampedPose::time);
  if (found == trajectory.end() || found->time != time) return {};
  return found->world_from_body;
}

// Consecutive frames and their poses relative to the first, from wheels.
struct Chain {
  std::vector<Timestamp> times;
  std::vector<Pose> first_from_body;
  std::vector<std::optional<Pose>> world_from_body;  // poses of the trajectory, if available
};

using FrameIndex = std::optional<std::size_t>;

// Pose of a frame from the nearest frames with a pose before and after it; empty if there is none.
std::optional<Pose> interpolated_pose(const Chain& chain, std::size_t frame, const FrameIndex& before,
                                      const FrameIndex& after) {
  const auto& known = chain.world_from_body;
  const auto measured = [&](std::size_t from, std::size_t to) {
    return inverse(chain.first_from_body[from]) * chain.first_from_body[to];
  };
  if (!before) return after ? std::optional(*known[*after] * measured(*after, frame)) : std::nullopt;
  if (!after) return *known[*before] * measured(*before, frame);
  const Pose correction = inverse(*known[*before]) * *known[*after] * inverse(measured(*before, *after));
  const double share =
      to_seconds(chain.times[frame] - chain.times[*before]) / to_seconds(chain.times[*after] - chain.times[*before]);
  return *known[*before] * interpolate(Pose{}, correction, share) * measured(*before, frame);
}

void add_poses(const Chain& chain, Trajectory& added) {
  const auto& known = chain.world_from_body;
  std::vector<FrameIndex> after(known.size());
  for (std::size_t i = known.size(); i-- > 1;) after[i - 1] = known[i] ? FrameIndex(i) : after[i];
  FrameIndex before;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (known[i]) {
      before = i;
    } else if (const auto pose = interpolated_pose(chain, i, before, after[i])) {
      added.push_back({chain.times[i], *pose});
    }
  }
}

}  // namespace

void GapTrajectory::note(Timestamp time, bool is_seen) {
  if (last_ && !(is_seen && was_seen_)) pending_.push_back({*last_, time, was_seen_, is_seen});
  if (pending_.size() > kMaxPendingFrames) pending_.pop_front();
  last_ = time;
  was_seen_ = is_seen;
}

bool GapTrajectory::is_seen(Timestamp earlier, Timestamp later) const {
  const auto is_before = [&](const Frames& frames) { return frames.later <= earlier; };
  const auto step = std::ranges::partition_point(steps_, is_before, &Step::frames);
  if (step != steps_.end()) return step->frames.earlier >= later;
  const auto pending = std::ranges::partition_point(pending_, is_before);
  return pending == pending_.end() || pending->earlier >= later;
}

std::deque<VisualMotion> GapTrajectory::motions_between_gaps(const Trajectory& seen, Timestamp length) const {
  std::deque<VisualMotion> motions;
  std::size_t begin = 0;
  for (std::size_t i = 1; i < seen.size(); ++i) {
    const bool is_gap = seen[i].time - seen[i - 1].time > kMaxFrameGap;
    if (is_gap || !is_seen(seen[i - 1].time, seen[i].time)) begin = i;
    if (seen[i].time - seen[begin].time < length) continue;
    motions.push_back({seen[begin].time, seen[i].time, inverse(seen[begin].world_from_body) * seen[i].world_from_body});
    begin = i;
  }
  return motions;
}

void GapTrajectory::note_located(const std::vector<Timestamp>& times) {
  const auto is_tracked = [&](Frames& frames) {
    frames.is_earlier_seen = frames.is_earlier_seen || std::ranges::binary_search(times, frames.earlier);
    frames.is_later_seen = frames.is_later_seen || std::ranges::binary_search(times, frames.later);
    return frames.is_earlier_seen && frames.is_later_seen;
  };
  std::erase_if(pending_, is_tracked);
  std::erase_if(steps_, [&](Step& step) { return is_tracked(step.frames); });
}

std::optional<Timestamp> GapTrajectory::first_pending() const {
  return pending_.empty() ? std::nullopt : std::optional(pending_.front().earlier);
}

void GapTrajectory::integrate(const BaseOdometry& odometry) {
  for (const Frames& frames : pending_) steps_.push_back({frames, odometry(frames.earlier, frames.later)});
  pending_.clear();
  while (steps_.size() > kMostSteps) steps_.pop_front();
}

Trajectory GapTrajectory::fill_gaps(Trajectory trajectory, const BodyMotionOf& body_motion_of, OldPoses old) const {
  Trajectory added;
  Chain chain;
  const auto begin_at = [&](Timestamp time) {
    add_poses(chain, added);
    chain = {{time}, {Pose{}}, {pose_of_frame(trajectory, time)}};
  };
  for (const Step& step : steps_) {
    if (chain.times.empty() || chain.times.back() != step.frames.earlier) begin_at(step.frames.earlier);
    if (!step.base) {
      begin_at(step.frames.later);
      continue;
    }
    chain.times.push_back(step.frames.later);
    chain.first_from_body.push_back(chain.first_from_body.back() * body_motion_of(*step.base));
    const bool is_known = step.frames.is_later_seen || old == OldPoses::kept;
    chain.world_from_body.push_back(is_known ? pose_of_frame(trajectory, step.frames.later) : std::nullopt);
  }
  add_poses(chain, added);
  std::erase_if(trajectory, [&](const StampedPose& pose) { return pose_of_frame(added, pose.time).has_value(); });
  const auto middle = static_cast<std::ptrdiff_t>(trajectory.size());
  trajectory.insert(trajectory.end(), added.begin(), added.end());
  std::ranges::inplace_merge(trajectory, trajectory.begin() + middle, {}, &StampedPose::time);
  return trajectory;
}

}  // namespace byre
