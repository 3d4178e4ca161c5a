#include "hot_loop.h"

#include "byre/place/place_index.h"

#include <algorithm>
#include <memory>
#include <random>

#include <benchmark/benchmark.h>

namespace byre {
namespace {

constexpr int kFeatures = 1000;  // per keyframe

Descriptor random_descriptor(std::mt19937_64& random) {
  return {random(), random(), random(), random()};
}

Vocabulary default_vocabulary() {
  return Vocabulary::load(default_vocabulary_path());
}

void load_vocabulary(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(default_vocabulary().word_count());
}
BENCHMARK(load_vocabulary)->Unit(benchmark::kMillisecond);

void find_words(benchmark::State& state) {
  const Vocabulary vocabulary = default_vocabulary();
  std::mt19937_64 random(1);
  std::vector<Descriptor> descriptors(kFeatures);
  for (Descriptor& descriptor : descriptors) descriptor = random_descriptor(random);
  const Features features(640, 480, std::vector<Keypoint>(kFeatures, Keypoint{{1.0f, 1.0f}}), descriptors, {});
  measure_hot_loop(state, [&] { benchmark::DoNotOptimize(vocabulary.words_of(features)); });
}
BENCHMARK(find_words)->Unit(benchmark::kMillisecond);

// Words with the frequency spread of real images: some occur a hundred times as often as others.
std::vector<Word> uneven_words(const Vocabulary& vocabulary, std::mt19937_64& random) {
  std::vector<Word> words(kFeatures);
  for (Word& word : words) {
    const double uniform = std::uniform_real_distribution(0.0, 1.0)(random);
    word = static_cast<Word>(uniform * uniform * (vocabulary.word_count() - 1));
  }
  return words;
}

// A chain of keyframes, each of which shares a point with each of its five neighbours on either side.
MapGraph chain_of_keyframes(int count, const Vocabulary& vocabulary) {
  constexpr int kNeighbours = 5;
  MapGraph map(Origin::offline);
  map.add_rig({});
  std::mt19937_64 random(2);
  const auto features =
      std::make_shared<const Features>(640, 480, std::vector<Keypoint>(kFeatures, Keypoint{{1.0f, 1.0f}}),
                                       std::vector<Descriptor>(kFeatures), std::vector<Patch>{});
  for (int i = 0; i < count; ++i) {
    Keyframe keyframe;
    keyframe.frame.features = features;
    keyframe.words = uneven_words(vocabulary, random);
    const KeyframeId id = map.add_keyframe(std::move(keyframe));
    for (int back = 1; back <= std::min(i, kNeighbours); ++back) {
      MapPoint point;
      point.reference = {{id.origin, id.number - static_cast<std::uint32_t>(back)}, back};
      const PointId shared = map.add_point(point);
      map.add_observation(point.reference, {shared});
      map.add_observation({id, kFeatures / 2 + back}, {shared});
    }
  }
  return map;
}

void index_a_map(benchmark::State& state) {
  const Vocabulary vocabulary = default_vocabulary();
  const MapGraph map = chain_of_keyframes(static_cast<int>(state.range(0)), vocabulary);
  for (auto _ : state) benchmark::DoNotOptimize(index_of(map, vocabulary).size());
}
BENCHMARK(index_a_map)->Unit(benchmark::kMillisecond)->Arg(1000);

void query_places(benchmark::State& state) {
  const Vocabulary vocabulary = default_vocabulary();
  const MapGraph map = chain_of_keyframes(static_cast<int>(state.range(0)), vocabulary);
  const MapGraph online(Origin::online);
  const MapView view(&map, online);
  const PlaceIndex index = index_of(map, vocabulary);
  std::mt19937_64 random(3);
  const std::vector<Word> words = uneven_words(vocabulary, random);
  std::size_t places = 0;
  measure_hot_loop(state, [&] { places = find_places(index, view, words, {}).size(); });
  state.counters["places"] = static_cast<double>(places);
}
BENCHMARK(query_places)->Unit(benchmark::kMillisecond)->Arg(1000)->Arg(10000);

}  // namespace
}  // namespace byre
