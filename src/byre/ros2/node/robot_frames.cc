#include "byre/ros2/node/robot_frames.h"

#include "byre/io/recording/static_frames.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

constexpr Timestamp kKept = 3s;
constexpr std::size_t kMaxSamples = 4000;  // per link
constexpr Timestamp kLongestGap = 500ms;
constexpr Timestamp kLongestExtrapolation = 100ms;
constexpr Timestamp kVelocityTime = 50ms;  // shortest time to measure a velocity in, if there are samples
constexpr Timestamp kOwned = 5s;

// Motion of a part of it, or beyond it.
Pose scaled(const Pose& motion, double share) {
  return {rotation_exp(share * rotation_log(motion.rotation)), share * motion.translation};
}

// Whether odometry restarted or was corrected: no indoor robot moves so fast.
bool is_jump(const Pose& motion, Timestamp passed) {
  constexpr double kMaxSpeed = 5.0, kMaxTurnRate = 10.0;  // m/s, rad/s
  constexpr double kRounding = 0.02;                      // m, rad
  const double seconds = to_seconds(passed);
  return motion.translation.norm() > kRounding + kMaxSpeed * seconds ||
         rotation_log(motion.rotation).norm() > kRounding + kMaxTurnRate * seconds;
}

}  // namespace

void PoseFrames::restart() {
  odom_from_start_.reset();
  odom_from_base_.reset();
  map_from_odom_.reset();
  is_held_ = false;
}

void PoseFrames::note(const FrameReport& report) {
  if (!std::exchange(is_odometry_own_, true)) map_from_odom_.reset();  // to another odom frame
  note_odometry(report);
  update(report, odom_from_base_);
}

void PoseFrames::note(const FrameReport& report, const std::optional<Pose>& odom_from_base_of_owner) {
  if (std::exchange(is_odometry_own_, false)) map_from_odom_.reset();
  note_odometry(report);
  update(report, odom_from_base_of_owner);
}

void PoseFrames::note_odometry(const FrameReport& report) {
  odom_from_base_.reset();
  if (!report.odometry_from_body) return;
  const Pose& start_from_base = *report.odometry_from_body;
  if (!odom_from_start_) odom_from_start_ = last_odom_from_base_ * inverse(start_from_base);
  last_odom_from_base_ = *odom_from_start_ * start_from_base;
  odom_from_base_ = last_odom_from_base_;
}

void PoseFrames::update(const FrameReport& report, const std::optional<Pose>& odom_from_base) {
  const bool is_known = report.map_from_body && odom_from_base && report.health.verdict != Verdict::untrusted;
  if (is_known) map_from_odom_ = *report.map_from_body * inverse(*odom_from_base);
  if (report.state == State::lost || report.has(SessionEvent::navigation_error)) map_from_odom_.reset();
  is_held_ = !is_known && map_from_odom_.has_value();
}

RobotFrames::RobotFrames(const Names& names)
    : names_{frame_without_slash(names.map), frame_without_slash(names.odom), frame_without_slash(names.base)} {}

RobotFrames::Link* RobotFrames::link(const ros::TransformStamped& transform) {
  constexpr std::size_t kMaxFrames = 1000;
  const std::string child = frame_without_slash(transform.child_frame_id);
  const std::string parent = frame_without_slash(transform.header.frame_id);
  if (child.empty() || parent.empty() || child == parent) return nullptr;
  if (links_.size() >= kMaxFrames && !links_.contains(child)) return nullptr;
  Link& found = links_[child];
  if (found.parent != parent) found = {parent, false, {}, {}};
  return &found;
}

void RobotFrames::add(const Sample& sample, Link& link) {
  std::deque<Sample>& samples = link.samples;
  if (!samples.empty()) {
    const Timestamp passed = sample.stamp - samples.back().stamp;
    if (passed <= Timestamp{} && passed > -kLongestGap) return;  // repeated or late
    const Pose motion = inverse(samples.back().parent_from_child) * sample.parent_from_child;
    if (passed <= Timestamp{} || is_jump(motion, passed)) samples.clear();
  }
  samples.push_back(sample);
  while (samples.size() > kMaxSamples || sample.stamp - samples.front().stamp > kKept) samples.pop_front();
}

void RobotFrames::take(const ros::TFMessage& message, Timestamp now) {
  for (const ros::TransformStamped& each : message.transforms) {
    const auto pose = pose_of_transform(each.transform);
    if (!pose) continue;
    if (Link* const found = link(each)) {
      found->is_static = false;
      found->arrival = now;
      add({ros::to_nanoseconds(each.header.stamp), *pose}, *found);
    }
    if (frame_without_slash(each.child_frame_id) == names_.odom) last_odom_parent_ = now;
  }
}

void RobotFrames::take_static(const ros::TFMessage& message) {
  for (const ros::TransformStamped& each : message.transforms) {
    const auto pose = pose_of_transform(each.transform);
    if (!pose) continue;
    if (Link* const found = link(each)) *found = {found->parent, true, {}, {{Timestamp{}, *pose}}};
  }
}

bool RobotFrames::has_parent(const std::string& frame) const {
  return links_.contains(frame_without_slash(frame));
}

bool RobotFrames::has_odom_owner(Timestamp now) const {
  const auto found = links_.find(names_.odom);
  if (found == links_.end()) return false;
  return found->second.is_static || (last_odom_parent_ && now - *last_odom_parent_ < kOwned);
}

std::optional<Pose> RobotFrames::at(const Link& link, Timestamp stamp) {
  const std::deque<Sample>& samples = link.samples;
  if (samples.empty()) return std::nullopt;
  if (link.is_static) return samples.front().parent_from_child;
  const auto after = std::ranges::lower_bound(samples, stamp, {}, &Sample::stamp);
  if (after != samples.end() && after->stamp == stamp) return after->parent_from_child;
  if (after == samples.begin()) return std::nullopt;
  auto before = std::prev(after);
  auto end = after;
  if (after == samples.end()) {
    if (stamp - before->stamp > kLongestExtrapolation) return std::nullopt;
    end = before;
    const Timestamp last = end->stamp;
    while (before != samples.begin() && last - before->stamp < kVelocityTime) --before;
    if (before == end) return std::nullopt;
  }
  const Timestamp passed = end->stamp - before->stamp;
  if (passed > kLongestGap) return std::nullopt;
  const double share = to_seconds(stamp - before->stamp) / to_seconds(passed);
  const Pose motion = inverse(before->parent_from_child) * end->parent_from_child;
  if (share <= 1.0) return before->parent_from_child * scaled(motion, share);
  return end->parent_from_child * scaled(motion, share - 1.0);
}

std::optional<Pose> RobotFrames::odom_from_base(Timestamp stamp) const {
  Pose frame_from_base;
  std::size_t steps = 0;
  for (auto found = links_.find(names_.base); found != links_.end() && steps <= links_.size(); ++steps) {
    const auto parent_from_frame = at(found->second, stamp);
    if (!parent_from_frame) return std::nullopt;
    frame_from_base = *parent_from_frame * frame_from_base;
    if (found->second.parent == names_.odom) return frame_from_base;
    found = links_.find(found->second.parent);
  }
  return std::nullopt;
}

std::optional<Timestamp> RobotFrames::last_odometry() const {
  std::optional<Timestamp> oldest;
  std::size_t steps = 0;
  for (auto found = links_.find(names_.base); found != links_.end() && steps <= links_.size(); ++steps) {
    const Link& link = found->second;
    if (!link.is_static) oldest = std::min(oldest.value_or(link.arrival), link.arrival);
    if (link.parent == names_.odom) return oldest;
    found = links_.find(link.parent);
  }
  return std::nullopt;
}

std::string RobotFrames::root_of_base() const {
  std::string frame = names_.base;
  std::size_t steps = 0;
  for (auto found = links_.find(frame); found != links_.end() && steps <= links_.size(); ++steps) {
    frame = found->second.parent;
    if (frame == names_.odom) return frame;
    found = links_.find(frame);
  }
  return frame;
}

}  // namespace byre
