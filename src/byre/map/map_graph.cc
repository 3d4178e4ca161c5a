#include "byre/map/map_graph.h"

#include <algorithm>
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

bool is_seen_by(const std::vector<Observation>& observations, KeyframeId keyframe) {
  return std::ranges::binary_search(observations, keyframe, {}, &Observation::keyframe);
}

KeyframeId keyframe_of_view(const ForeignView& view) {
  return view.observation.keyframe;
}

auto& sighting_of(auto& keyframe, int feature) {
  assert(feature >= 0 && static_cast<std::size_t>(feature) < keyframe.sightings.size());
  return keyframe.sightings[static_cast<std::size_t>(feature)];
}

bool shares_more(const Covisible& first, const Covisible& second) {
  if (first.shared_points != second.shared_points) return first.shared_points > second.shared_points;
  return first.keyframe < second.keyframe;
}

}  // namespace

int MapGraph::add_rig(const Rig& rig) {
  const auto known = std::ranges::find_if(rigs_, [&](const Rig& candidate) { return is_equal(candidate, rig); });
  const auto index = static_cast<int>(known - rigs_.begin());
  if (known == rigs_.end()) rigs_.push_back(rig);
  return index;
}

KeyframeId MapGraph::add_keyframe(Keyframe keyframe) {
  read_all();
  const KeyframeId id{origin_, static_cast<std::uint32_t>(keyframes_.size())};
  const int feature_count = keyframe.frame.features ? keyframe.frame.features->size() : 0;
  keyframe.sightings.resize(std::max(keyframe.sightings.size(), static_cast<std::size_t>(feature_count)));
  const std::vector<Sighting> sightings = keyframe.sightings;
  for (Sighting& sighting : keyframe.sightings) sighting.point.reset();
  keyframe.parent = living_ancestor(keyframe.parent);

  if (keyframe.parent) edit_slot(*keyframe.parent).children.push_back(id);
  keyframes_.emplace_back().edit().keyframe = std::move(keyframe);
  ++keyframe_count_;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (sightings[i].point) add_observation({id, static_cast<int>(i)}, sightings[i]);
  }
  return id;
}

PointId MapGraph::add_point(const MapPoint& point) {
  read_all();
  const PointId id{origin_, static_cast<std::uint32_t>(point_slots_.size())};
  if (free_point_slots_.empty()) {
    point_slots_.emplace_back() = static_cast<std::uint32_t>(points_.size());
    points_.emplace_back();
  } else {
    point_slots_.emplace_back() = free_point_slots_.back();
    free_point_slots_.pop_back();
  }
  edit_slot(id).point = point;
  ++point_count_;
  return id;
}

bool MapGraph::add_observation(const Observation& observation, const Sighting& sighting) {
  assert(sighting.point);
  read_all();
  const PointId point = *sighting.point;
  const Keyframe* const keyframe = find_own_keyframe(observation.keyframe);
  const bool is_known = point.origin == origin_ ? find_slot(point) != nullptr : origin_ == Origin::online;
  if (!keyframe || !is_known || sighting_of(*keyframe, observation.feature).point) return false;
  if (is_seen_by(observations(point), observation.keyframe)) return false;

  std::vector<Observation>& observers = edit_observations(point);
  count_shared_point(observers, observation.keyframe, 1);
  observers.insert(lower_bound_of(observers, observation.keyframe), observation);
  sighting_of(edit_keyframe(observation.keyframe), observation.feature) = sighting;
  return true;
}

void MapGraph::remove_observation(const Observation& observation) {
  read_all();
  const std::optional<PointId> point = unlink(observation);
  if (!point || point->origin != origin_) return;
  if (observations(*point).empty()) {
    remove_point(*point);
  } else {
    repair_reference(*point);
  }
}

bool MapGraph::add_foreign_view(const ForeignView& view) {
  assert(view.sighting.point);
  const PointId point = *view.sighting.point;
  const KeyframeId keyframe = view.observation.keyframe;
  if (keyframe.origin == origin_ || origin_ == Origin::offline || !find_point(point)) return false;
  const std::vector<ForeignView>& present = foreign_views(point);
  if (std::ranges::binary_search(present, keyframe, {}, keyframe_of_view)) return false;
  if (!points_of_foreign_views_.edit().emplace(view.observation, point).second) return false;
  std::vector<ForeignView>& views = foreign_views_.edit()[point];
  views.insert(std::ranges::lower_bound(views, keyframe, {}, keyframe_of_view), view);
  return true;
}

void MapGraph::remove_foreign_view(const Observation& observation) {
  const std::optional<PointId> point = point_of_foreign_view(observation);
  if (!point) return;
  std::vector<ForeignView>& views = foreign_views_.edit()[*point];
  views.erase(std::ranges::lower_bound(views, observation.keyframe, {}, keyframe_of_view));
  if (views.empty()) foreign_views_.edit().erase(*point);
  points_of_foreign_views_.edit().erase(observation);
}

void MapGraph::remove_point(PointId id) {
  read_all();
  if (!find_point(id)) return;
  const std::vector<Observation> observers = observations(id);
  for (const Observation& observation : observers) unlink(observation);
  if (foreign_views_->contains(id)) {
    for (const ForeignView& view : foreign_views(id)) points_of_foreign_views_.edit().erase(view.observation);
    foreign_views_.edit().erase(id);
  }
  edit_slot(id) = {};
  free_point_slots_.push_back(std::exchange(point_slots_.edit(id.number), kGone));
  --point_count_;
}

void MapGraph::remove_keyframe(KeyframeId id) {
  read_all();
  const Keyframe* keyframe = find_keyframe(id);
  if (!keyframe || !keyframe->parent) return;
  const KeyframeId parent = *keyframe->parent;
  const Pose camera_from_parent = keyframe->camera_from_world * inverse(camera_from_world(parent));
  const int rig = keyframe->rig;
  const std::size_t features = keyframe->sightings.size();
  for (std::size_t i = 0; i < features; ++i) remove_observation({id, static_cast<int>(i)});

  reparent_children(id, parent);
  edit_slot(id).keyframe.reset();
  edit_slot(id).removed = RemovedKeyframe{rig, parent, camera_from_parent};
  --keyframe_count_;
}

Keyframe MapGraph::take_keyframe(KeyframeId id) {
  read_all();
  return std::move(edit_keyframe(id));
}

void MapGraph::set_words(KeyframeId id, std::vector<Word> words) {
  read_all();
  if (!find_own_keyframe(id)) return;
  assert(words.empty() || words.size() == slot(id).keyframe->sightings.size());
  edit_keyframe(id).words = std::move(words);
}

void MapGraph::set_picture(KeyframeId id, StoredPicture picture) {
  read_all();
  if (!find_own_keyframe(id)) return;
  Keyframe& keyframe = edit_keyframe(id);
  keyframe.picture = std::move(picture);
  keyframe.frame.picture.reset();
}

void MapGraph::move_keyframe(KeyframeId id, const Pose& camera_from_world, const Matrix6& covariance) {
  read_all();
  if (!find_own_keyframe(id)) return;
  Keyframe& keyframe = edit_keyframe(id);
  keyframe.camera_from_world = camera_from_world;
  keyframe.covariance = covariance;
}

void MapGraph::scale_removed_keyframe(KeyframeId id, double scale) {
  if (!was_assigned(id) || !slot(id).removed) return;
  edit_slot(id).removed->camera_from_parent.translation *= scale;
}

void MapGraph::update_point(PointId id, const MapPoint& point) {
  read_all();
  if (!find_point(id)) return;
  edit_slot(id).point = point;
  repair_reference(id);
}

const Keyframe* MapGraph::find_keyframe(KeyframeId id) const {
  const Keyframe* const header = keyframe_header(id);
  return header && source_ ? &source_->keyframe(id.number, *header) : header;
}

const Keyframe* MapGraph::keyframe_header(KeyframeId id) const {
  if (!was_assigned(id) || !slot(id).keyframe) return nullptr;
  return &*slot(id).keyframe;
}

const MapPoint* MapGraph::find_point(PointId id) const {
  const ObservedPoint* const found = find_observed(id);
  return found ? &found->point : nullptr;
}

std::vector<KeyframeId> MapGraph::keyframe_ids() const {
  std::vector<KeyframeId> ids;
  ids.reserve(static_cast<std::size_t>(keyframe_count_));
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) {
    if (keyframes_[i]->keyframe) ids.push_back({origin_, i});
  }
  return ids;
}

std::vector<PointId> MapGraph::point_ids() const {
  std::vector<PointId> ids;
  ids.reserve(static_cast<std::size_t>(point_count_));
  const auto given_out = source_ ? static_cast<std::size_t>(point_count_) : point_slots_.size();
  for (std::uint32_t i = 0; i < given_out; ++i) {
    if (source_ || point_slots_[i] != kGone) ids.push_back({origin_, i});
  }
  return ids;
}

void MapGraph::visit_words(const MapSource::WordVisitor& visit) const {
  if (source_) return source_->visit_words(visit);
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) {
    if (keyframes_[i]->keyframe) visit({origin_, i}, keyframes_[i]->keyframe->words);
  }
}

const std::vector<Observation>& MapGraph::observations(PointId id) const {
  static const std::vector<Observation> kNone;
  if (id.origin == origin_) {
    const ObservedPoint* const found = find_observed(id);
    return found ? found->observations : kNone;
  }
  return id.number < offline_observations_.size() ? offline_observations_[id.number] : kNone;
}

const std::vector<ForeignView>& MapGraph::foreign_views(PointId id) const {
  static const std::vector<ForeignView> kNone;
  const auto found = foreign_views_->find(id);
  return found != foreign_views_->end() ? found->second : kNone;
}

std::vector<Observation> MapGraph::foreign_observations(KeyframeId offline) const {
  std::vector<Observation> observations;
  for (auto view = points_of_foreign_views_->lower_bound({offline, 0});
       view != points_of_foreign_views_->end() && view->first.keyframe == offline; ++view) {
    observations.push_back(view->first);
  }
  return observations;
}

std::optional<PointId> MapGraph::point_of_foreign_view(const Observation& observation) const {
  const auto known = points_of_foreign_views_->find(observation);
  if (known == points_of_foreign_views_->end()) return std::nullopt;
  return known->second;
}

ScratchVector<Covisible> MapGraph::covisible_keyframes(KeyframeId id, int max_count) const {
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

Pose MapGraph::camera_from_world(KeyframeId id) const {
  assert(was_assigned(id));
  Pose camera_from_ancestor;
  while (!slot(id).keyframe) {
    camera_from_ancestor = camera_from_ancestor * slot(id).removed->camera_from_parent;
    id = slot(id).removed->parent;
  }
  return camera_from_ancestor * slot(id).keyframe->camera_from_world;
}

std::optional<KeyframeId> MapGraph::living_ancestor(std::optional<KeyframeId> id) const {
  if (!id || !was_assigned(*id)) return std::nullopt;
  while (!slot(*id).keyframe) id = slot(*id).removed->parent;
  return id;
}

bool MapGraph::was_assigned(KeyframeId id) const {
  return id.origin == origin_ && id.number < keyframes_.size();
}

const Keyframe* MapGraph::find_own_keyframe(KeyframeId id) const {
  if (!was_assigned(id) || !slot(id).keyframe) return nullptr;
  return &*slot(id).keyframe;
}

const ObservedPoint* MapGraph::find_observed(PointId id) const {
  if (!source_) return find_slot(id);
  return id.origin == origin_ && std::cmp_less(id.number, point_count_) ? &source_->point(id.number) : nullptr;
}

const ObservedPoint* MapGraph::find_slot(PointId id) const {
  if (id.origin != origin_ || id.number >= point_slots_.size()) return nullptr;
  const std::uint32_t place = point_slots_[id.number];
  return place == kGone ? nullptr : &points_[place];
}

std::vector<Observation>& MapGraph::edit_observations(PointId id) {
  if (id.origin == origin_) return edit_slot(id).observations;
  while (id.number >= offline_observations_.size()) offline_observations_.emplace_back();
  return offline_observations_.edit(id.number);
}

std::optional<PointId> MapGraph::unlink(const Observation& observation) {
  const Keyframe* const keyframe = find_own_keyframe(observation.keyframe);
  if (!keyframe || !sighting_of(*keyframe, observation.feature).point) return std::nullopt;

  Sighting& sighting = sighting_of(edit_keyframe(observation.keyframe), observation.feature);
  const PointId point = *sighting.point;
  std::vector<Observation>& observers = edit_observations(point);
  observers.erase(lower_bound_of(observers, observation.keyframe));
  sighting.point.reset();
  count_shared_point(observers, observation.keyframe, -1);
  return point;
}

void MapGraph::count_shared_point(const std::vector<Observation>& observers, KeyframeId with, int change) {
  for (const Observation& observation : observers) {
    add_shared_points(observation.keyframe, with, change);
    add_shared_points(with, observation.keyframe, change);
  }
}

void MapGraph::add_shared_points(KeyframeId keyframe, KeyframeId with, int change) {
  std::vector<Covisible>& covisible = edit_slot(keyframe).covisible;
  auto place = std::ranges::lower_bound(covisible, with, {}, &Covisible::keyframe);
  if (place == covisible.end() || place->keyframe != with) place = covisible.insert(place, Covisible{with, 0});
  place->shared_points += change;
  if (place->shared_points == 0) covisible.erase(place);
}

void MapGraph::repair_reference(PointId id) {
  const ObservedPoint& seen = *find_slot(id);
  if (seen.observations.empty() || std::ranges::binary_search(seen.observations, seen.point.reference)) return;
  ObservedPoint& repaired = edit_slot(id);
  repaired.point.reference = repaired.observations.front();
}

void MapGraph::reparent_children(KeyframeId id, KeyframeId parent) {
  const std::vector<KeyframeId> adopted = std::exchange(edit_slot(id).children, {});
  for (const KeyframeId child : adopted) edit_keyframe(child).parent = parent;

  std::vector<KeyframeId> children;
  std::ranges::set_union(slot(parent).children, adopted, std::back_inserter(children));
  std::erase(children, id);
  edit_slot(parent).children = std::move(children);
}

}  // namespace byre
