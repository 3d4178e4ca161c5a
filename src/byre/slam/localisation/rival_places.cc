#include "byre/slam/localisation/rival_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace byre {
namespace {

constexpr double kSamePlace = 0.5;      // metres
constexpr std::size_t kMostRivals = 5;  // bounds the time of a frame

// Log-odds of the rivals of a rival: its test never accepts.
constexpr double kNeverAccepted = std::numeric_limits<double>::infinity();

}  // namespace

bool RivalPlaces::is_recent(Timestamp time) const {
  constexpr double kShortly = 1.0;  // seconds
  return last_ && to_seconds(time - last_->time) <= kShortly;
}

double RivalPlaces::reach(Timestamp time) const {
  constexpr double kSlack = 0.3;  // metres, error of poses
  return kSlack + options_.max_speed * to_seconds(time - last_->time);
}

Pose RivalPlaces::offline_from_last(const Rival& rival) const {
  return rival.rival_from_place * inverse(last_->camera_from_place);
}

const PlaceHypothesis* RivalPlaces::find_test(Timestamp time, const Pose& camera_from_offline) const {
  if (!is_recent(time)) return nullptr;
  const Eigen::Vector3d camera = inverse(camera_from_offline).translation;
  const auto is_near = [&](const Pose& offline_from_camera) {
    return (offline_from_camera.translation - camera).norm() <= reach(time);
  };
  if (!last_->place.is_accepted() && is_near(inverse(last_->camera_from_place))) return &last_->place;
  const auto rival =
      std::ranges::find_if(rivals_, [&](const Rival& known) { return is_near(offline_from_last(known)); });
  return rival != rivals_.end() ? &rival->test : nullptr;
}

std::optional<PlaceHypothesis> RivalPlaces::begin(Timestamp time, const Pose& camera_from_place) {
  const PlaceHypothesis* const known = find_test(time, camera_from_place);
  const std::optional<PlaceHypothesis> place = known != nullptr ? std::optional(*known) : std::nullopt;
  if (is_recent(time)) {
    const Eigen::Vector3d camera = inverse(camera_from_place).translation;
    if (!last_->place.is_accepted()) rivals_.push_back({Pose{}, last_->place, camera, 0.0, 1});
    std::erase_if(rivals_, [&](const Rival& rival) {
      return (offline_from_last(rival).translation - camera).norm() <= reach(time);
    });
    for (Rival& rival : rivals_) {
      rival.rival_from_place = offline_from_last(rival) * camera_from_place;
      rival.of_path.reset();
    }
  } else {
    rivals_.clear();
  }
  last_.reset();
  return place;
}

void RivalPlaces::propose(const Pose& camera_from_place, const Pose& camera_from_rival, double prior) {
  const Eigen::Vector3d camera = inverse(camera_from_place).translation;
  const Eigen::Vector3d at_rival = inverse(camera_from_rival).translation;
  const auto is_same = [&](const Eigen::Vector3d& known) { return (known - at_rival).norm() <= kSamePlace; };
  if (rivals_.size() >= kMostRivals || is_same(camera)) return;
  if (std::ranges::any_of(rivals_, is_same, [&](const Rival& rival) { return rival.rival_from_place * camera; }))
    return;
  const PlaceHypothesis test(prior, options_.confirmations, options_.accept_log_odds);
  rivals_.push_back({inverse(camera_from_rival) * camera_from_place, test, camera});
}

bool RivalPlaces::has_at(const Pose& camera_from_place, const Pose& camera_from_rival) const {
  constexpr double kNear = 1.0;  // metres
  const Eigen::Vector3d camera = inverse(camera_from_place).translation;
  const Eigen::Vector3d at_rival = inverse(camera_from_rival).translation;
  return std::ranges::any_of(
      rivals_, [&](const Rival& rival) { return (rival.rival_from_place * camera - at_rival).norm() <= kNear; });
}

// A frame that is not tracked is no evidence if no keyframe saw the map from nearby: points look different from another
// direction.
void RivalPlaces::observe(const Pose& camera_from_place, const TrackAt& track_at) {
  const Eigen::Vector3d camera = inverse(camera_from_place).translation;
  for (Rival& rival : rivals_) {
    const View seen = track_at(camera_from_place * inverse(rival.rival_from_place));
    if (!seen.is_tracked && !seen.view.is_near_keyframe) continue;
    rival.frames += seen.is_tracked;
    rival.rival_from_place = inverse(seen.camera_from_offline) * camera_from_place;
    rival.test.observe(seen.view, true, kNeverAccepted);
    rival.way = std::max(rival.way, (camera - rival.proposed_at).norm());
  }
  std::erase_if(rivals_, [](const Rival& rival) { return rival.frames == 0 || rival.test.is_rejected(); });
}

void RivalPlaces::note_place(Timestamp time, const Pose& camera_from_place, const PlaceHypothesis& place) {
  last_ = {time, camera_from_place, place.is_accepted() ? PlaceHypothesis() : place};
}

double RivalPlaces::log_odds() const {
  double odds = 0.0;
  for (const Rival& rival : rivals_) odds += std::exp(rival.test.log_odds());
  return std::log(odds);
}

std::optional<Pose> RivalPlaces::camera_from_likeliest() const {
  if (rivals_.empty() || !last_) return std::nullopt;
  const auto likeliest =
      std::ranges::max_element(rivals_, {}, [](const Rival& rival) { return rival.test.log_odds(); });
  return inverse(offline_from_last(*likeliest));
}

bool RivalPlaces::refute(const PlaceHypothesis& place, bool is_by_hint, const OfPath& of_path) {
  constexpr int kFrames = 3;
  constexpr double kWay = 2.0;             // metres
  const double of_rival = std::log(20.0);  // log-likelihood ratio of the rival to an accepted place
  return std::ranges::any_of(rivals_, [&](Rival& rival) {
    const double log_odds = rival.test.log_odds();
    if (rival.frames < kFrames || log_odds < 0.0) return false;
    if (!place.is_accepted() && !is_by_hint) return log_odds > place.log_odds_to_rivals();
    const double least = std::max(0.0, place.log_odds_to_rivals() + of_rival);
    if (rival.way < kWay || log_odds < least) return false;
    if (!rival.of_path) rival.of_path = of_path ? of_path(rival.rival_from_place) : 0.0;
    return log_odds + *rival.of_path >= least;
  });
}

}  // namespace byre
