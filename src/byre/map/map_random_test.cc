// Compares the map with a naive model that recomputes the data that the map maintains.

#include "byre/map/map_graph.h"

#include <limits>
#include <map>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kMostFeatures = 12;
constexpr int kOfflinePoints = 5;

struct Model {
  std::map<Observation, PointId> sightings;
  std::map<KeyframeId, std::optional<KeyframeId>> parents;  // parents of living keyframes
  std::map<PointId, Observation> references;                // reference views of living online points

  std::vector<Observation> observations(PointId point) const {
    std::vector<Observation> found;
    for (const auto& [observation, seen] : sightings) {
      if (seen == point) found.push_back(observation);
    }
    return found;
  }

  bool sees(KeyframeId keyframe, PointId point) const {
    const std::vector<Observation> all = observations(point);
    return std::ranges::find(all, keyframe, &Observation::keyframe) != all.end();
  }

  bool add_observation(const Observation& observation, PointId point) {
    const bool is_known = point.origin == Origin::offline || references.contains(point);
    if (!is_known || !parents.contains(observation.keyframe)) return false;
    if (sightings.contains(observation) || sees(observation.keyframe, point)) return false;
    return sightings.emplace(observation, point).second;
  }

  void drop_unseen_points_and_repair_references() {
    for (auto entry = references.begin(); entry != references.end();) {
      const std::vector<Observation> seen_by = observations(entry->first);
      if (seen_by.empty()) {
        entry = references.erase(entry);
        continue;
      }
      if (std::ranges::find(seen_by, entry->second) == seen_by.end()) entry->second = seen_by.front();
      ++entry;
    }
  }

  void remove_point(PointId point) {
    std::erase_if(sightings, [&](const auto& entry) { return entry.second == point; });
    references.erase(point);
  }

  void remove_keyframe(KeyframeId keyframe) {
    const auto entry = parents.find(keyframe);
    if (entry == parents.end() || !entry->second) return;
    const KeyframeId parent = *entry->second;
    parents.erase(entry);
    for (auto& [child, its_parent] : parents) {
      if (its_parent == keyframe) its_parent = parent;
    }
    std::erase_if(sightings, [&](const auto& sighting) { return sighting.first.keyframe == keyframe; });
    drop_unseen_points_and_repair_references();
  }

  std::vector<std::pair<KeyframeId, int>> covisible(KeyframeId keyframe) const {
    std::map<KeyframeId, int> counts;
    for (const auto& [observation, point] : sightings) {
      if (observation.keyframe != keyframe) continue;
      for (const Observation& other : observations(point)) ++counts[other.keyframe];
    }
    counts.erase(keyframe);
    std::vector<std::pair<KeyframeId, int>> sorted(counts.begin(), counts.end());
    std::ranges::stable_sort(sorted, std::greater<>{}, &std::pair<KeyframeId, int>::second);
    return sorted;
  }
};

// Applies the same random operations to a map and to its model.
class RandomOperations {
 public:
  explicit RandomOperations(std::uint64_t seed) : random_(seed) { map.add_rig({}); }

  void step() {
    const int dice = below(100);
    if (dice < 8) return add_keyframe();
    if (dice < 30) return add_point();
    if (dice < 70) return add_observation();
    if (dice < 82) return remove_observation();
    if (dice < 90) return remove_point();
    remove_keyframe();
  }

  MapGraph map{Origin::online};
  Model model;

 private:
  int below(int limit) { return static_cast<int>(random_() % static_cast<std::uint64_t>(limit)); }
  // Mostly recent numbers, which may be removed or not yet assigned.
  std::uint32_t recent(std::uint32_t count) {
    const auto back = static_cast<std::uint32_t>(below(12));
    return count > back ? count - back : 0;
  }
  KeyframeId any_keyframe() { return {Origin::online, recent(keyframes_)}; }
  PointId any_online_point() { return {Origin::online, recent(points_)}; }
  PointId any_point() {
    if (below(5) > 0) return any_online_point();
    return {Origin::offline, static_cast<std::uint32_t>(below(kOfflinePoints))};
  }
  Observation any_observation() { return {any_keyframe(), below(kMostFeatures)}; }

  void add_keyframe() {
    static const auto kSharedFeatures =
        std::make_shared<Features>(640, 480, std::vector<Keypoint>(kMostFeatures, Keypoint{{1.0f, 1.0f}}),
                                   std::vector<Descriptor>(kMostFeatures), std::vector<Patch>{});
    Keyframe keyframe;
    keyframe.frame.features = kSharedFeatures;
    if (const KeyframeId parent = any_keyframe(); model.parents.contains(parent)) keyframe.parent = parent;
    for (int i = 0; i < kMostFeatures / 2; ++i) keyframe.sightings.push_back({any_point()});

    const std::vector<Sighting> wanted = keyframe.sightings;
    const std::optional<KeyframeId> parent = keyframe.parent;
    const KeyframeId id = map.add_keyframe(std::move(keyframe));
    ASSERT_EQ(id.number, keyframes_++);
    model.parents[id] = parent;
    for (int i = 0; i < kMostFeatures / 2; ++i) {
      model.add_observation({id, i}, *wanted[static_cast<std::size_t>(i)].point);
    }
  }

  // A point always has an observation, so it is added with one.
  void add_point() {
    const Observation reference = any_observation();
    if (!model.parents.contains(reference.keyframe) || model.sightings.contains(reference)) return;
    MapPoint point;
    point.reference = reference;
    const PointId id = map.add_point(point);
    ASSERT_EQ(id.number, points_++);
    model.references[id] = reference;
    EXPECT_TRUE(map.add_observation(reference, {id}));
    model.add_observation(reference, id);
  }

  void add_observation() {
    const Observation observation = any_observation();
    const PointId point = any_point();
    EXPECT_EQ(map.add_observation(observation, {point}), model.add_observation(observation, point));
  }

  void remove_observation() {
    const Observation observation = any_observation();
    map.remove_observation(observation);
    model.sightings.erase(observation);
    model.drop_unseen_points_and_repair_references();
  }

  void remove_point() {
    const PointId point = any_online_point();
    map.remove_point(point);
    model.remove_point(point);
  }

  void remove_keyframe() {
    const KeyframeId keyframe = any_keyframe();
    map.remove_keyframe(keyframe);
    model.remove_keyframe(keyframe);
  }

  std::mt19937_64 random_;
  std::uint32_t keyframes_ = 0;
  std::uint32_t points_ = 0;
};

void expect_same_keyframes(const MapGraph& map, const Model& model) {
  ASSERT_EQ(static_cast<std::size_t>(map.keyframe_count()), model.parents.size());
  for (const auto& [id, parent] : model.parents) {
    const Keyframe* keyframe = map.find_keyframe(id);
    ASSERT_NE(keyframe, nullptr);
    ASSERT_EQ(keyframe->parent, parent);
    for (int i = 0; i < kMostFeatures; ++i) {
      const auto seen = model.sightings.find({id, i});
      const std::optional<PointId> expected =
          seen == model.sightings.end() ? std::nullopt : std::optional(seen->second);
      ASSERT_EQ(keyframe->sightings[static_cast<std::size_t>(i)].point, expected);
    }
  }
}

void expect_same_points(const MapGraph& map, const Model& model) {
  ASSERT_EQ(static_cast<std::size_t>(map.point_count()), model.references.size());
  for (const auto& [id, reference] : model.references) {
    ASSERT_NE(map.find_point(id), nullptr);
    ASSERT_EQ(map.find_point(id)->reference, reference);
    ASSERT_EQ(map.observations(id), model.observations(id));
  }
  for (std::uint32_t i = 0; i < kOfflinePoints; ++i) {
    ASSERT_EQ(map.observations({Origin::offline, i}), model.observations({Origin::offline, i}));
  }
}

void expect_same_covisibility(const MapGraph& map, const Model& model) {
  for (const auto& [id, parent] : model.parents) {
    std::vector<std::pair<KeyframeId, int>> maintained;
    for (const auto& [keyframe, shared] : map.covisible_keyframes(id, std::numeric_limits<int>::max())) {
      maintained.emplace_back(keyframe, shared);
    }
    ASSERT_EQ(maintained, model.covisible(id));
  }
}

class MapUnderRandomOperations : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(MapUnderRandomOperations, EqualsTheReferenceModelAndStaysValid) {
  RandomOperations operations(GetParam());
  for (int i = 0; i < 1000 && !HasFailure(); ++i) {
    SCOPED_TRACE("step " + std::to_string(i));
    operations.step();
    expect_same_keyframes(operations.map, operations.model);
    expect_same_points(operations.map, operations.model);
    ASSERT_THAT(find_faults(operations.map), ::testing::IsEmpty());
    if (i % 20 == 0) expect_same_covisibility(operations.map, operations.model);
  }
  EXPECT_GT(operations.map.point_count(), 5) << "the operations must leave points to compare";
}

// Copies share memory until one of them changes.
TEST_P(MapUnderRandomOperations, LeavesItsCopies) {
  RandomOperations operations(GetParam());
  for (int i = 0; i < 10 && !HasFailure(); ++i) {
    SCOPED_TRACE("copy " + std::to_string(i));
    for (int step = 0; step < 50; ++step) operations.step();
    const MapGraph copy = operations.map;
    const Model model = operations.model;
    for (int step = 0; step < 50; ++step) operations.step();
    expect_same_keyframes(copy, model);
    expect_same_points(copy, model);
    expect_same_covisibility(copy, model);
    ASSERT_THAT(find_faults(copy), ::testing::IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, MapUnderRandomOperations, ::testing::Values(1, 2, 3, 4, 5));

}  // namespace
}  // namespace byre
