#include "byre/map/map.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace byre {
namespace {

bool is_equal(const Pose& first, const Pose& second) {
  return first.rotation.coeffs() == second.rotation.coeffs() && first.translation == second.translation;
}

bool is_equal(const Rig& first, const Rig& second) {
  return first.width == second.width && first.height == second.height && first.focal == second.focal &&
         first.cx == second.cx && first.cy == second.cy && first.baseline == second.baseline &&
         is_equal(first.body_from_camera, second.body_from_camera);
}

// The observation by a keyframe, or its insertion point.
auto lower_bound_of(std::vector<Observation>& observations, KeyframeId keyframe) {
  return std::ranges::lower_bound(observations, keyframe, {}, &Observation::keyframe);
}

bool is_seen_by(std::vector<Observation>& observations, KeyframeId keyframe) {
  const auto place = lower_bound_of(observations, keyframe);
  return place != observations.end() && place->keyframe == keyframe;
}

KeyframeId keyframe_of_view(const ForeignView& view) {
  return view.observation.keyframe;
}

Sighting& sighting_of(Keyframe& keyframe, int feature) {
  assert(feature >= 0 && static_cast<std::size_t>(feature) < keyframe.sightings.size());
  return keyframe.sightings[static_cast<std::size_t>(feature)];
}

bool shares_more(const Covisible& first, const Covisible& second) {
  if (first.shared_points != second.shared_points) return first.shared_points > second.shared_points;
  return first.keyframe < second.keyframe;
}

}  // namespace

int Map::add_rig(const Rig& rig) {
  const auto known = std::ranges::find_if(rigs_, [&](const Rig& candidate) { return is_equal(candidate, rig); });
  const auto index = static_cast<int>(known - rigs_.begin());
  if (known == rigs_.end()) rigs_.push_back(rig);
  return index;
}

KeyframeId Map::add_keyframe(Keyframe keyframe) {
  read_all();
  const KeyframeId id{origin_, static_cast<std::uint32_t>(keyframes_.size())};
  const int feature_count = keyframe.frame.features ? keyframe.frame.features->size() : 0;
  keyframe.sightings.resize(std::max(keyframe.sightings.size(), static_cast<std::size_t>(feature_count)));
  const std::vector<Sighting> sightings = keyframe.sightings;
  for (Sighting& sighting : keyframe.sightings) sighting.point.reset();
  keyframe.parent = living_ancestor(keyframe.parent);

  if (keyframe.parent) slot(*keyframe.parent).children.push_back(id);
  keyframes_.emplace_back().keyframe = std::move(keyframe);
  ++keyframe_count_;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (sightings[i].point) add_observation({id, static_cast<int>(i)}, sightings[i]);
  }
  return id;
}

PointId Map::add_point(const MapPoint& point) {
  read_all();
  const PointId id{origin_, static_cast<std::uint32_t>(point_slots_.size())};
  if (free_point_slots_.empty()) {
    point_slots_.push_back(static_cast<std::uint32_t>(points_.size()));
    points_.emplace_back();
  } else {
    point_slots_.push_back(free_point_slots_.back());
    free_point_slots_.pop_back();
  }
  slot(id).point = point;
  ++point_count_;
  return id;
}

bool Map::add_observation(const Observation& observation, const Sighting& sighting) {
  assert(sighting.point);
  read_all();
  Keyframe* keyframe = find_own_keyframe(observation.keyframe);
  std::vector<Observation>* observers = find_observations(*sighting.point);
  if (!keyframe || !observers) return false;
  Sighting& place = sighting_of(*keyframe, observation.feature);
  if (place.point || is_seen_by(*observers, observation.keyframe)) return false;

  count_shared_point(*observers, observation.keyframe, 1);
  observers->insert(lower_bound_of(*observers, observation.keyframe), observation);
  place = sighting;
  return true;
}

void Map::remove_observation(const Observation& observation) {
  read_all();
  const std::optional<PointId> point = unlink(observation);
  if (!point || point->origin != origin_) return;
  if (observations(*point).empty()) {
    remove_point(*point);
  } else {
    repair_reference(*point);
  }
}

bool Map::add_foreign_view(const ForeignView& view) {
  assert(view.sighting.point);
  const PointId point = *view.sighting.point;
  const KeyframeId keyframe = view.observation.keyframe;
  if (keyframe.origin == origin_ || origin_ == Origin::offline || !find_point(point)) return false;
  const std::vector<ForeignView>& present = foreign_views(point);
  if (std::ranges::binary_search(present, keyframe, {}, keyframe_of_view)) return false;
  if (!points_of_foreign_views_.emplace(view.observation, point).second) return false;
  std::vector<ForeignView>& views = foreign_views_[point];
  views.insert(std::ranges::lower_bound(views, keyframe, {}, keyframe_of_view), view);
  return true;
}

void Map::remove_foreign_view(const Observation& observation) {
  const auto known = points_of_foreign_views_.find(observation);
  if (known == points_of_foreign_views_.end()) return;
  std::vector<ForeignView>& views = foreign_views_[known->second];
  views.erase(std::ranges::lower_bound(views, observation.keyframe, {}, keyframe_of_view));
  if (views.empty()) foreign_views_.erase(known->second);
  points_of_foreign_views_.erase(known);
}

void Map::remove_point(PointId id) {
  read_all();
  if (!find_point(id)) return;
  const std::vector<Observation> observers = observations(id);
  for (const Observation& observation : observers) unlink(observation);
  for (const ForeignView& view : foreign_views(id)) points_of_foreign_views_.erase(view.observation);
  foreign_views_.erase(id);
  slot(id) = {};
  free_point_slots_.push_back(std::exchange(point_slots_[id.number], kGone));
  --point_count_;
}

void Map::remove_keyframe(KeyframeId id) {
  read_all();
  const Keyframe* keyframe = find_keyframe(id);
  if (!keyframe || !keyframe->parent) return;
  const KeyframeId parent = *keyframe->parent;
  const Pose camera_from_parent = keyframe->camera_from_world * inverse(camera_from_world(parent));
  for (std::size_t i = 0; i < keyframe->sightings.size(); ++i) remove_observation({id, static_cast<int>(i)});

  const int rig = keyframe->rig;
  reparent_children(id, parent);
  slot(id).keyframe.reset();
  slot(id).removed = RemovedKeyframe{rig, parent, camera_from_parent};
  --keyframe_count_;
}

Keyframe Map::take_keyframe(KeyframeId id) {
  read_all();
  return std::move(*slot(id).keyframe);
}

void Map::set_words(KeyframeId id, std::vector<Word> words) {
  read_all();
  Keyframe* keyframe = find_own_keyframe(id);
  if (!keyframe) return;
  assert(words.empty() || words.size() == keyframe->sightings.size());
  keyframe->words = std::move(words);
}

void Map::move_keyframe(KeyframeId id, const Pose& camera_from_world, const Matrix6& covariance) {
  read_all();
  Keyframe* keyframe = find_own_keyframe(id);
  if (!keyframe) return;
  keyframe->camera_from_world = camera_from_world;
  keyframe->covariance = covariance;
}

void Map::scale_removed_keyframe(KeyframeId id, double scale) {
  if (!was_assigned(id) || !slot(id).removed) return;
  slot(id).removed->camera_from_parent.translation *= scale;
}

void Map::update_point(PointId id, const MapPoint& point) {
  read_all();
  if (!find_point(id)) return;
  slot(id).point = point;
  repair_reference(id);
}

const Keyframe* Map::find_keyframe(KeyframeId id) const {
  const Keyframe* const header = keyframe_header(id);
  return header && source_ ? &source_->keyframe(id.number, *header) : header;
}

const Keyframe* Map::keyframe_header(KeyframeId id) const {
  if (!was_assigned(id) || !slot(id).keyframe) return nullptr;
  return &*slot(id).keyframe;
}

const MapPoint* Map::find_point(PointId id) const {
  const ObservedPoint* const found = find_observed(id);
  return found ? &found->point : nullptr;
}

std::vector<KeyframeId> Map::keyframe_ids() const {
  std::vector<KeyframeId> ids;
  ids.reserve(static_cast<std::size_t>(keyframe_count_));
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) {
    if (keyframes_[i].keyframe) ids.push_back({origin_, i});
  }
  return ids;
}

std::vector<PointId> Map::point_ids() const {
  std::vector<PointId> ids;
  ids.reserve(static_cast<std::size_t>(point_count_));
  const auto given_out = source_ ? static_cast<std::size_t>(point_count_) : point_slots_.size();
  for (std::uint32_t i = 0; i < given_out; ++i) {
    if (source_ || point_slots_[i] != kGone) ids.push_back({origin_, i});
  }
  return ids;
}

void Map::visit_words(const MapSource::WordVisitor& visit) const {
  if (source_) return source_->visit_words(visit);
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) {
    if (keyframes_[i].keyframe) visit({origin_, i}, keyframes_[i].keyframe->words);
  }
}

const std::vector<Observation>& Map::observations(PointId id) const {
  static const std::vector<Observation> kNone;
  if (id.origin == origin_) {
    const ObservedPoint* const found = find_observed(id);
    return found ? found->observations : kNone;
  }
  return id.number < offline_observations_.size() ? offline_observations_[id.number] : kNone;
}

const std::vector<ForeignView>& Map::foreign_views(PointId id) const {
  static const std::vector<ForeignView> kNone;
  const auto found = foreign_views_.find(id);
  return found != foreign_views_.end() ? found->second : kNone;
}

std::vector<Observation> Map::foreign_observations(KeyframeId offline) const {
  std::vector<Observation> observations;
  for (auto view = points_of_foreign_views_.lower_bound({offline, 0});
       view != points_of_foreign_views_.end() && view->first.keyframe == offline; ++view) {
    observations.push_back(view->first);
  }
  return observations;
}

std::optional<PointId> Map::point_of_foreign_view(const Observation& observation) const {
  const auto known = points_of_foreign_views_.find(observation);
  if (known == points_of_foreign_views_.end()) return std::nullopt;
  return known->second;
}

ScratchVector<Covisible> Map::covisible_keyframes(KeyframeId id, int max_count) const {
  if (!keyframe_header(id)) return {};
  ScratchVector<Covisible> covisible;
  if (source_) {
    covisible = source_->covisible(id.number);
  } else {
    covisible.assign(slot(id).covisible.begin(), slot(id).covisible.end());
  }
  const auto count = std::min(covisible.size(), static_cast<std::size_t>(std::max(max_count, 0)));
  std::ranges::partial_sort(covisible, covisible.begin() + static_cast<std::ptrdiff_t>(count), shares_more);
  covisible.resize(count);
  return covisible;
}

Pose Map::camera_from_world(KeyframeId id) const {
  assert(was_assigned(id));
  Pose camera_from_ancestor;
  while (!slot(id).keyframe) {
    camera_from_ancestor = camera_from_ancestor * slot(id).removed->camera_from_parent;
    id = slot(id).removed->parent;
  }
  return camera_from_ancestor * slot(id).keyframe->camera_from_world;
}

std::optional<KeyframeId> Map::living_ancestor(std::optional<KeyframeId> id) const {
  if (!id || !was_assigned(*id)) return std::nullopt;
  while (!slot(*id).keyframe) id = slot(*id).removed->parent;
  return id;
}

bool Map::was_assigned(KeyframeId id) const {
  return id.origin == origin_ && id.number < keyframes_.size();
}

Keyframe* Map::find_own_keyframe(KeyframeId id) {
  if (!was_assigned(id) || !slot(id).keyframe) return nullptr;
  return &*slot(id).keyframe;
}

const ObservedPoint* Map::find_observed(PointId id) const {
  if (!source_) return find_slot(id);
  return id.origin == origin_ && std::cmp_less(id.number, point_count_) ? &source_->point(id.number) : nullptr;
}

const ObservedPoint* Map::find_slot(PointId id) const {
  if (id.origin != origin_ || id.number >= point_slots_.size()) return nullptr;
  const std::uint32_t place = point_slots_[id.number];
  return place == kGone ? nullptr : &points_[place];
}

std::vector<Observation>* Map::find_observations(PointId id) {
  if (id.origin == origin_) return find_slot(id) ? &slot(id).observations : nullptr;
  if (origin_ == Origin::offline) return nullptr;
  if (id.number >= offline_observations_.size()) offline_observations_.resize(id.number + std::size_t{1});
  return &offline_observations_[id.number];
}

std::optional<PointId> Map::unlink(const Observation& observation) {
  Keyframe* keyframe = find_own_keyframe(observation.keyframe);
  if (!keyframe) return std::nullopt;
  Sighting& sighting = sighting_of(*keyframe, observation.feature);
  if (!sighting.point) return std::nullopt;

  const PointId point = *sighting.point;
  std::vector<Observation>& observers = *find_observations(point);
  observers.erase(lower_bound_of(observers, observation.keyframe));
  count_shared_point(observers, observation.keyframe, -1);
  sighting.point.reset();
  return point;
}

void Map::count_shared_point(const std::vector<Observation>& observers, KeyframeId with, int change) {
  for (const Observation& observation : observers) {
    add_shared_points(observation.keyframe, with, change);
    add_shared_points(with, observation.keyframe, change);
  }
}

void Map::add_shared_points(KeyframeId keyframe, KeyframeId with, int change) {
  std::vector<Covisible>& covisible = slot(keyframe).covisible;
  auto place = std::ranges::lower_bound(covisible, with, {}, &Covisible::keyframe);
  if (place == covisible.end() || place->keyframe != with) place = covisible.insert(place, Covisible{with, 0});
  place->shared_points += change;
  if (place->shared_points == 0) covisible.erase(place);
}

void Map::repair_reference(PointId id) {
  ObservedPoint& point_slot = slot(id);
  const std::vector<Observation>& observers = point_slot.observations;
  if (observers.empty() || std::ranges::binary_search(observers, point_slot.point.reference)) return;
  point_slot.point.reference = observers.front();
}

void Map::reparent_children(KeyframeId id, KeyframeId parent) {
  std::vector<KeyframeId>& adopted = slot(id).children;
  for (const KeyframeId child : adopted) slot(child).keyframe->parent = parent;

  std::vector<KeyframeId> children;
  std::ranges::set_union(slot(parent).children, adopted, std::back_inserter(children));
  std::erase(children, id);
  slot(parent).children = std::move(children);
  adopted.clear();
}

}  // namespace byre
