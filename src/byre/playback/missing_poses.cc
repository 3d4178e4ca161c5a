#include "byre/playback/missing_poses.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

namespace byre {
namespace {

// Poses world_from_body by frame time.
using Poses = std::map<Timestamp, Pose>;

// Pose at a frame next to a located one, at constant velocity. step: -1 or 1, from the located frame to the other one.
Pose predict(const Poses& poses, const std::vector<Timestamp>& times, int located, int step) {
  constexpr double kLongest = 0.5;  // seconds over which the velocity is assumed constant
  const Pose& last = poses.at(times[static_cast<std::size_t>(located)]);
  const int before = located - step;
  if (before < 0 || before >= static_cast<int>(times.size())) return last;
  const auto known = poses.find(times[static_cast<std::size_t>(before)]);
  if (known == poses.end()) return last;
  const double passed = to_seconds(times[static_cast<std::size_t>(located)] - known->first);
  const double ahead =
      to_seconds(times[static_cast<std::size_t>(located + step)] - times[static_cast<std::size_t>(located)]);
  if (std::abs(ahead) > kLongest || std::abs(passed) > kLongest) return last;
  return last * exp_pose(log_pose(inverse(known->second) * last) * (ahead / passed));
}

// Reads frames in ascending order, because reading a compressed recording backwards is slow.
class Images {
 public:
  explicit Images(const FramesAgain& frames) : frames_(frames) {}

  const std::optional<ImageFrame>& before(int number) {
    constexpr int kAtOnce = 16;
    const int wanted = number - 1;
    if (wanted < begin_ || wanted >= begin_ + static_cast<int>(images_.size())) {
      begin_ = std::max(0, number - kAtOnce);
      images_.clear();
      for (int i = begin_; i < number; ++i) images_.push_back(frames_.read(i));
    }
    return images_[static_cast<std::size_t>(wanted - begin_)];
  }

 private:
  const FramesAgain& frames_;
  int begin_ = 0;  // number of the first frame in images_
  std::vector<std::optional<ImageFrame>> images_;
};

// Locates frames from one next to a located frame onwards, until one has a pose or is not found.
void locate_from(SlamImpl& slam, int located, int step, const FramesAgain& frames, Poses& poses) {
  const auto count = static_cast<int>(frames.times.size());
  Images images(frames);
  for (int i = located + step; i >= 0 && i < count; i += step) {
    const Timestamp time = frames.times[static_cast<std::size_t>(i)];
    if (poses.contains(time) || frames.should_stop()) return;
    const std::optional<ImageFrame> shown = step > 0 ? frames.read(i) : images.before(i + 1);
    const auto pose =
        shown ? slam.locate_in_finished_map(*shown, predict(poses, frames.times, i - step, step)) : std::nullopt;
    if (!pose) return;
    poses[time] = *pose;
  }
}

// Localises missing frames without a prediction, and continues from each in both directions.
void find_places(SlamImpl& slam, const FramesAgain& frames, Poses& poses) {
  constexpr Timestamp kInterval = std::chrono::milliseconds(200);  // after a frame that is not found
  Timestamp next = Timestamp::min();
  for (int i = 0; i < static_cast<int>(frames.times.size()); ++i) {
    const Timestamp time = frames.times[static_cast<std::size_t>(i)];
    if (time < next || poses.contains(time)) continue;
    if (frames.should_stop()) return;
    next = time + kInterval;
    const std::optional<ImageFrame> shown = frames.read(i);
    const auto pose = shown ? slam.find_in_finished_map(*shown) : std::nullopt;
    if (!pose) continue;
    poses[time] = *pose;
    locate_from(slam, i, 1, frames, poses);
    locate_from(slam, i, -1, frames, poses);
  }
}

}  // namespace

Trajectory located_again(SlamImpl& slam, const Trajectory& located, const FramesAgain& frames) {
  Trajectory found;
  for (const StampedPose& pose : located) {
    if (frames.should_stop()) return located;
    const auto time = std::ranges::lower_bound(frames.times, pose.time);
    if (time == frames.times.end() || *time != pose.time) continue;
    const std::optional<ImageFrame> shown = frames.read(static_cast<int>(time - frames.times.begin()));
    if (!shown) continue;
    if (const auto again = slam.locate_in_finished_map(*shown, pose.world_from_body))
      found.push_back({pose.time, *again});
  }
  return found;
}

Trajectory with_missing_poses(SlamImpl& slam, const Trajectory& located, const FramesAgain& frames) {
  Poses poses;
  for (const StampedPose& pose : located) poses[pose.time] = pose.world_from_body;
  const auto has_pose = [&](int i) { return poses.contains(frames.times[static_cast<std::size_t>(i)]); };
  for (int i = 0; i + 1 < static_cast<int>(frames.times.size()); ++i) {
    if (has_pose(i) && !has_pose(i + 1)) locate_from(slam, i, 1, frames, poses);
  }
  for (int i = static_cast<int>(frames.times.size()) - 1; i > 0; --i) {
    if (has_pose(i) && !has_pose(i - 1)) locate_from(slam, i, -1, frames, poses);
  }
  if (!slam.rig().is_stereo() && slam.prior().is_empty()) find_places(slam, frames, poses);
  Trajectory all;
  for (const auto& [time, pose] : poses) all.push_back({time, pose});
  return all;
}

}  // namespace byre
