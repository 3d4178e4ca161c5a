// Part of slam_impl.h: the maps of a site.

#include "byre/slam/system/slam_impl.h"

#include <any>
#include <utility>

namespace byre {
namespace {

std::unique_ptr<Executor> make_search_lane(Pace pace) {
  switch (pace) {
    case Pace::same_thread:
      return make_inline_executor();
    case Pace::paced:
      return make_paced_executor(kPacedSearchLatency);
    case Pace::live:
      return make_live_executor();
  }
  return nullptr;
}

}  // namespace

void SlamImpl::begin_site() {
  if (inputs_.maps.empty()) inputs_.maps.push_back({"", inputs_.offline, {}, 0, inputs_.plan});
  std::vector<std::optional<PlanRegistration>> plans;
  for (const MissionMap& map : inputs_.maps) plans.push_back(map.plan);
  active_.emplace(inputs_.links, std::move(plans), options_.session.mission.registration);
  if (inputs_.maps.size() > 1) site_lane_ = make_search_lane(options_.pace);
}

std::optional<std::size_t> SlamImpl::choose_map(const Frame& frame, FrameReport& report) {
  constexpr double kSearchEvery = 0.25;  // seconds
  report.map = inputs_.maps[active_->index()].name;
  if (std::exchange(is_map_changed_, false)) report.events.insert(report.events.begin(), SessionEvent::map_changed);
  if (map_since_ && report.odometry_from_body)
    report.odometry_from_body = odometry_before_ * *report.odometry_from_body;
  if (auto finished = site_lane_ ? site_lane_->collect() : std::nullopt) {
    active_->note_search(std::any_cast<std::vector<PlaceSearch>>(std::move(finished->result)));
  }
  const auto next = active_->note(report, session_->log_odds_of_place());
  was_proved_ = was_proved_ || active_->is_proved();
  if (!active_->is_proved() && report.health.verdict != Verdict::untrusted) {
    report.health.verdict = Verdict::untrusted;
    report.health.doubt = DistrustReason::unconfirmed;
  }
  if (!site_lane_ || !site_lane_->idle() || !active_->is_search_due(frame.time)) return next;
  const bool is_due = !last_search_ || to_seconds(frame.time - *last_search_) >= kSearchEvery;
  if (!is_due) return next;
  last_search_ = frame.time;
  std::vector<std::shared_ptr<const OfflineMap>> maps;
  for (const MissionMap& map : inputs_.maps) maps.push_back(map.offline);
  const SessionOptions& options = session_->options();
  site_lane_->submit([frame, rig = rig(), maps = std::move(maps),
                      options = PlaceSearchOptions{options.relocalise, options.mission.bounds}] {
    return std::any(search_places(maps, {frame, rig}, options));
  });
  return next;
}

// The online map belongs to the map that it was made on, so a new session begins. Wheels and cameras stay calibrated.
void SlamImpl::change_map(std::size_t map, const FrameReport& last) {
  if (was_proved_) earlier_poses_ = trajectory();
  map_since_ = last.time;
  odometry_before_ = last.odometry_from_body.value_or(odometry_before_);
  inputs_.offline = inputs_.maps[map].offline;
  inputs_.plan = inputs_.maps[map].plan;
  session_->finish_early();
  const bool is_paused = session_->is_mapping_paused();
  Session::KnownCameras cameras = session_->known_cameras();
  begin_session(cameras.rig);
  session_->continue_cameras(std::move(cameras));
  session_->pause_mapping(is_paused);
  record_ = {};
  moved_tags_.clear();
  had_pose_ = false;
  was_proved_ = false;
  is_map_changed_ = true;
}

Trajectory SlamImpl::with_filled_gaps(Trajectory seen) const {
  Trajectory all = prior_.fill_gaps(std::move(seen));
  if (!map_since_) return all;
  std::erase_if(all, [this](const StampedPose& pose) { return pose.time <= *map_since_; });
  all.insert(all.begin(), earlier_poses_.begin(), earlier_poses_.end());
  return all;
}

std::optional<PlanRegistration> SlamImpl::plan() const {
  if (inputs_.maps.size() < 2) return inputs_.plan;
  return calls_.run([this] { return inputs_.plan; });
}

}  // namespace byre
