#include "byre/place/place_index.h"

#include "byre/place/vocabulary_scene.h"

#include <algorithm>
#include <memory>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kAll = 1000;
constexpr Word kWordsEach = 40;  // words per image

MATCHER_P2(PlaceOf, keyframe, score, "") {
  return arg.keyframe == keyframe && std::abs(arg.score - score) < 1e-6f;
}

KeyframeId offline(std::uint32_t number) {
  return {Origin::offline, number};
}

// A vocabulary of about a hundred words with different weights.
Vocabulary random_vocabulary() {
  std::vector<std::vector<Descriptor>> images;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) images.push_back(random_descriptors(100, seed));
  VocabularyOptions options;
  options.branching = 10;
  options.depth = 2;
  return Vocabulary::train(images, options);
}

// A vocabulary of word_count words with equal weights.
Vocabulary plain_vocabulary(int word_count) {
  std::vector<std::vector<Descriptor>> images;
  for (const Descriptor& descriptor : random_descriptors(word_count, 1)) images.push_back({descriptor});
  VocabularyOptions options;
  options.branching = word_count;
  options.depth = 1;
  return Vocabulary::train(images, options);
}

std::vector<Word> random_words(const Vocabulary& vocabulary, std::mt19937_64& random) {
  std::vector<Word> words(kWordsEach);
  for (Word& word : words) word = static_cast<Word>(random() % static_cast<std::uint64_t>(vocabulary.word_count()));
  return words;
}

class RandomIndex : public testing::Test {
 protected:
  static constexpr std::uint32_t kKeyframes = 50;

  RandomIndex() {
    for (std::uint32_t number = 0; number < kKeyframes; ++number) {
      words[offline(number)] = random_words(vocabulary, random);
      index.add(offline(number), words[offline(number)]);
    }
  }

  // Expected result of a query, by comparison with each keyframe.
  std::vector<PlaceMatch> compare_with_each(const BagOfWords& query) const {
    std::vector<PlaceMatch> matches;
    for (const auto& [id, keyframe_words] : words) {
      const float score = similarity(query, vocabulary.bag_of(keyframe_words));
      if (score > 0.0f) matches.push_back({id, score});
    }
    std::ranges::stable_sort(matches, std::greater(), &PlaceMatch::score);
    return matches;
  }

  void expect_like_each(const BagOfWords& query) const {
    const std::vector<PlaceMatch> expected = compare_with_each(query);
    const std::vector<PlaceMatch> matches = index.query(query, kAll);
    ASSERT_THAT(matches, SizeIs(expected.size()));
    for (std::size_t i = 0; i < matches.size(); ++i)
      EXPECT_THAT(matches[i], PlaceOf(expected[i].keyframe, expected[i].score));
  }

  std::mt19937_64 random{1};
  Vocabulary vocabulary = random_vocabulary();
  PlaceIndex index{vocabulary};
  std::map<KeyframeId, std::vector<Word>> words;
};

TEST_F(RandomIndex, ScoresLikeExhaustiveComparison) {
  for (int i = 0; i < 10; ++i) expect_like_each(vocabulary.bag_of(random_words(vocabulary, random)));
}

TEST_F(RandomIndex, FindsAKeyframeByItsOwnWords) {
  for (const auto& [id, keyframe_words] : words) {
    EXPECT_THAT(index.query(vocabulary.bag_of(keyframe_words), 1), ElementsAre(PlaceOf(id, 1.0f)));
  }
}

TEST_F(RandomIndex, RemovesAndRestoresKeyframes) {
  const BagOfWords query = vocabulary.bag_of(random_words(vocabulary, random));
  for (std::uint32_t number = 0; number < kKeyframes; number += 3) {
    index.remove(offline(number));
    words.erase(offline(number));
  }
  EXPECT_EQ(index.size(), static_cast<int>(words.size()));
  expect_like_each(query);
  for (std::uint32_t number = kKeyframes; number < kKeyframes + 5; ++number) {
    words[offline(number)] = random_words(vocabulary, random);
    index.add(offline(number), words[offline(number)]);
  }
  expect_like_each(query);
}

TEST_F(RandomIndex, ReplacesTheWordsOfAKeyframe) {
  words[offline(7)] = random_words(vocabulary, random);
  index.add(offline(7), words[offline(7)]);
  EXPECT_EQ(index.size(), static_cast<int>(kKeyframes));
  expect_like_each(vocabulary.bag_of(random_words(vocabulary, random)));
}

TEST_F(RandomIndex, IsIndependentOfTheOrderOfKeyframes) {
  PlaceIndex backwards(vocabulary);
  for (auto entry = words.rbegin(); entry != words.rend(); ++entry) backwards.add(entry->first, entry->second);
  const BagOfWords query = vocabulary.bag_of(random_words(vocabulary, random));
  const std::vector<PlaceMatch> expected = index.query(query, kAll), matches = backwards.query(query, kAll);
  ASSERT_EQ(matches.size(), expected.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    EXPECT_EQ(matches[i].keyframe, expected[i].keyframe);
    EXPECT_EQ(matches[i].score, expected[i].score) << "to the last bit";
  }
}

TEST_F(RandomIndex, IsBitIdenticalIfBuiltFromAWholeMap) {
  MapGraph map(Origin::offline);
  map.add_rig({});
  for (const auto& [id, keyframe_words] : words) {
    Keyframe keyframe;
    keyframe.sightings.resize(keyframe_words.size());
    keyframe.words = keyframe_words;
    keyframe.words.push_back(keyframe.words.front());  // a repeated word, and one outside the vocabulary
    keyframe.words.push_back(1u << 30);
    keyframe.sightings.resize(keyframe.words.size());
    index.add(map.add_keyframe(keyframe), keyframe.words);
  }
  PlaceIndex whole = index_of(map, vocabulary);
  const auto expect_equal = [&] {
    const BagOfWords query = vocabulary.bag_of(random_words(vocabulary, random));
    const std::vector<PlaceMatch> expected = index.query(query, kAll), matches = whole.query(query, kAll);
    ASSERT_EQ(matches.size(), expected.size());
    for (std::size_t i = 0; i < matches.size(); ++i) {
      EXPECT_EQ(matches[i].keyframe, expected[i].keyframe);
      EXPECT_EQ(matches[i].score, expected[i].score);
    }
  };
  expect_equal();
  for (PlaceIndex* const changed : {&index, &whole}) {
    changed->remove(offline(3));
    changed->add(offline(5), words[offline(7)]);
  }
  EXPECT_EQ(whole.size(), index.size());
  expect_equal();
}

TEST_F(RandomIndex, ExcludesKeyframesBeforeCounting) {
  const BagOfWords query = vocabulary.bag_of(random_words(vocabulary, random));
  const std::vector<PlaceMatch> all = index.query(query, 3);
  const auto matches = index.query(query, 2, [&all](KeyframeId id) { return id == all[0].keyframe; });
  EXPECT_THAT(matches, ElementsAre(PlaceOf(all[1].keyframe, all[1].score), PlaceOf(all[2].keyframe, all[2].score)));
}

TEST(PlaceIndexTest, BreaksTiesByTheLowerId) {
  PlaceIndex index(plain_vocabulary(4));
  const std::vector<Word> words = {0, 1};
  for (const std::uint32_t number : {5u, 2u, 9u}) index.add(offline(number), words);
  index.add({Origin::online, 0}, words);
  const auto matches = index.query(index.vocabulary().bag_of(words), 3);
  EXPECT_THAT(matches, ElementsAre(PlaceOf(offline(2), 1.0f), PlaceOf(offline(5), 1.0f), PlaceOf(offline(9), 1.0f)));
}

TEST(PlaceIndexTest, ReturnsNothingWithoutCommonWords) {
  PlaceIndex index(plain_vocabulary(4));
  const BagOfWords query = index.vocabulary().bag_of(std::vector<Word>{2, 3});
  EXPECT_THAT(index.query(query, kAll), IsEmpty());
  index.add(offline(0), std::vector<Word>{0, 1});
  index.add(offline(1), {});
  EXPECT_THAT(index.query(query, kAll), IsEmpty());
  EXPECT_THAT(index.query({}, kAll), IsEmpty());
  EXPECT_THAT(index.query({{77, 1.0f}}, kAll), IsEmpty()) << "a word of another vocabulary";
  EXPECT_THAT(index.query(index.vocabulary().bag_of(std::vector<Word>{0}), 0), IsEmpty());
  index.remove(offline(99));
  EXPECT_EQ(index.size(), 2);
}

// A map of two rooms with three keyframes each; keyframes of a room share points.
class TwoRooms : public testing::Test {
 protected:
  static constexpr int kFeatures = 4;
  static constexpr Word kUnknownWord = 99;

  TwoRooms() {
    map.add_rig({});
    for (int room = 0; room < 2; ++room) {
      for (int i = 0; i < 3; ++i) keyframes.push_back(map.add_keyframe(blank_keyframe()));
      for (int feature = 0; feature < 2; ++feature) add_point(room * 3, feature);
    }
  }

  static Keyframe blank_keyframe() {
    Keyframe keyframe;
    keyframe.frame.features =
        std::make_shared<Features>(640, 480, std::vector<Keypoint>(kFeatures, Keypoint{{1.0f, 1.0f}}),
                                   random_descriptors(kFeatures, 3), std::vector<Patch>{});
    keyframe.words.assign(kFeatures, kUnknownWord);
    return keyframe;
  }

  // Adds a point with observations in three keyframes.
  void add_point(int first, int feature) {
    MapPoint point;
    point.reference = {keyframes[static_cast<std::size_t>(first)], feature};
    const PointId id = map.add_point(point);
    for (int i = first; i < first + 3; ++i)
      map.add_observation({keyframes[static_cast<std::size_t>(i)], feature}, {id});
  }

  // The other features of the keyframe get words outside the vocabulary.
  void show(int keyframe, std::vector<Word> words) {
    words.resize(kFeatures, kUnknownWord);
    map.set_words(keyframes[static_cast<std::size_t>(keyframe)], std::move(words));
  }

  std::vector<PlaceCandidate> places(const std::vector<Word>& words, const PlaceQueryOptions& options = {},
                                     const std::function<bool(KeyframeId)>& is_excluded = {}) const {
    const MapGraph online(Origin::online);
    return find_places(index_of(map, vocabulary), MapView(&map, online), words, options, is_excluded);
  }

  const Vocabulary vocabulary = plain_vocabulary(8);
  MapGraph map{Origin::offline};
  std::vector<KeyframeId> keyframes;
};

TEST_F(TwoRooms, AreGroupedByCovisibility) {
  show(0, {0, 1, 2, 3});
  show(1, {0, 1, 4, 5});
  show(2, {0, 4, 5, 6});
  show(3, {0, 1, 2, 7});
  const std::vector<PlaceCandidate> found = places({0, 1, 2, 3});
  ASSERT_THAT(found, SizeIs(1)) << "the other room has less than half the score of the first";
  EXPECT_EQ(found[0].keyframe, keyframes[0]);
  EXPECT_FLOAT_EQ(found[0].score, 1.0f);
  EXPECT_FLOAT_EQ(found[0].group_score, 1.75f);
  EXPECT_THAT(found[0].group, ElementsAre(keyframes[0], keyframes[1], keyframes[2]));
}

TEST_F(TwoRooms, PreferAPlaceOfSeveralSimilarKeyframes) {
  show(0, {0, 1, 2, 3});
  show(3, {0, 1, 2, 7});
  show(5, {1, 2, 3, 7});
  const std::vector<PlaceCandidate> found = places({0, 1, 2, 3});
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].keyframe, keyframes[3]) << "the lower id of two in the room";
  EXPECT_FLOAT_EQ(found[0].group_score, 1.5f);
  EXPECT_THAT(found[0].group, ElementsAre(keyframes[3], keyframes[5]));
  EXPECT_EQ(found[1].keyframe, keyframes[0]);
  EXPECT_THAT(found[1].group, ElementsAre(keyframes[0]));
}

TEST_F(TwoRooms, CountAtMostTheGivenNeighbours) {
  for (int i = 0; i < 6; ++i) show(i, {0, 1});
  PlaceQueryOptions options;
  options.group_size = 1;
  const std::vector<PlaceCandidate> found = places({0, 1}, options);
  EXPECT_THAT(found, ElementsAre(Field(&PlaceCandidate::group, ElementsAre(keyframes[0], keyframes[1])),
                                 Field(&PlaceCandidate::group, ElementsAre(keyframes[3], keyframes[4])),
                                 Field(&PlaceCandidate::group, ElementsAre(keyframes[2])),
                                 Field(&PlaceCandidate::group, ElementsAre(keyframes[5]))));
}

TEST_F(TwoRooms, AreLimitedInNumber) {
  for (int i = 0; i < 6; ++i) show(i, {0, 1});
  PlaceQueryOptions options;
  options.max_candidates = 1;
  EXPECT_THAT(places({0, 1}, options), SizeIs(1));
  options.max_candidates = 0;
  EXPECT_THAT(places({0, 1}, options), IsEmpty());
}

TEST_F(TwoRooms, AreFoundWithoutTheExcludedKeyframes) {
  for (int i = 0; i < 6; ++i) show(i, {0, 1});
  const auto found = places({0, 1}, {}, [this](KeyframeId id) { return id.number < keyframes[4].number; });
  EXPECT_THAT(found, ElementsAre(Field(&PlaceCandidate::group, ElementsAre(keyframes[4], keyframes[5]))));
}

TEST_F(TwoRooms, AreIndexedByDescriptorsWithoutWords) {
  for (const KeyframeId id : keyframes) map.set_words(id, {});
  const PlaceIndex index = index_of(map, vocabulary);
  EXPECT_EQ(index.size(), 6);
  const std::vector<Word> words = vocabulary.words_of(*map.find_keyframe(keyframes[0])->frame.features);
  EXPECT_THAT(index.query(vocabulary.bag_of(words), kAll),
              testing::Each(Field(&PlaceMatch::score, testing::FloatEq(1.0f))));
}

// A sequence of keyframes with random words, each covisible with its predecessors. Some have equal words.
class RowOfRooms : public testing::Test {
 protected:
  static constexpr int kKeyframes = 600;  // enough for indexing on several threads
  static constexpr int kNeighbours = 3;

  RowOfRooms() {
    map.add_rig({});
    const auto features =
        std::make_shared<const Features>(640, 480, std::vector<Keypoint>(kWordsEach, Keypoint{{1.0f, 1.0f}}),
                                         random_descriptors(kWordsEach, 3), std::vector<Patch>{});
    for (int i = 0; i < kKeyframes; ++i) {
      Keyframe keyframe;
      keyframe.frame.features = features;
      keyframe.words = random_words(vocabulary, random);
      if (i % 50 == 1) keyframe.words = map.find_keyframe({Origin::offline, static_cast<std::uint32_t>(i) - 1})->words;
      const KeyframeId id = map.add_keyframe(std::move(keyframe));
      for (int back = 1; back <= std::min(i, kNeighbours); ++back) see_together(id, back);
    }
  }

  void see_together(KeyframeId id, int back) {
    MapPoint point;
    point.reference = {{id.origin, id.number - static_cast<std::uint32_t>(back)}, back};
    const PointId shared = map.add_point(point);
    map.add_observation(point.reference, {shared});
    map.add_observation({id, static_cast<int>(kWordsEach) / 2 + back}, {shared});
  }

  // Expected result: groups of all matches, formed from the best match downwards; the best groups are kept.
  std::vector<PlaceCandidate> places_of_all(const PlaceIndex& index, std::vector<PlaceMatch> matches,
                                            const PlaceQueryOptions& options) const {
    std::vector<PlaceCandidate> all;
    while (!matches.empty()) {
      const auto covisible = map.covisible_keyframes(matches.front().keyframe, options.group_size);
      PlaceCandidate group{matches.front().keyframe, matches.front().score, 0.0f, {}};
      std::erase_if(matches, [&](const PlaceMatch& match) {
        const bool is_in = match.keyframe == group.keyframe ||
                           std::ranges::find(covisible, match.keyframe, &Covisible::keyframe) != covisible.end();
        if (is_in) group.group_score += match.score;
        if (is_in) group.group.push_back(match.keyframe);
        return is_in;
      });
      all.push_back(std::move(group));
    }
    EXPECT_EQ(index.size(), kKeyframes);
    std::ranges::stable_sort(all, [](const PlaceCandidate& a, const PlaceCandidate& b) {
      return a.group_score != b.group_score ? a.group_score > b.group_score : a.keyframe < b.keyframe;
    });
    std::erase_if(all, [least = options.min_score_share * (all.empty() ? 0.0f : all.front().group_score)](
                           const PlaceCandidate& candidate) { return candidate.group_score < least; });
    all.resize(std::min(all.size(), static_cast<std::size_t>(options.max_candidates)));
    return all;
  }

  std::mt19937_64 random{1};
  const Vocabulary vocabulary = random_vocabulary();
  MapGraph map{Origin::offline};
};

TEST_F(RowOfRooms, ReturnsThePlacesOfAnExhaustiveSearch) {
  const PlaceIndex index = index_of(map, vocabulary);
  const MapGraph online(Origin::online);
  const auto is_excluded = [](KeyframeId id) { return id.number % 7 == 3; };
  for (const PlaceQueryOptions& options :
       {PlaceQueryOptions{}, PlaceQueryOptions{.max_candidates = 3}, PlaceQueryOptions{.group_size = 1},
        PlaceQueryOptions{.min_score_share = 0.9f},
        PlaceQueryOptions{.max_candidates = kKeyframes, .min_score_share = 0.0f}}) {
    for (std::uint32_t number = 0; number < kKeyframes; number += 25) {
      std::vector<Word> words = random_words(vocabulary, random);
      if (number % 2 == 0) words = map.find_keyframe({Origin::offline, number})->words;
      const auto matches = index.query(vocabulary.bag_of(words), kAll, is_excluded);
      const std::vector<PlaceCandidate> expected = places_of_all(index, matches, options);
      const auto found = find_places(index, MapView(&map, online), words, options, is_excluded);
      ASSERT_THAT(found, SizeIs(expected.size()));
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].keyframe, expected[i].keyframe);
        EXPECT_EQ(found[i].score, expected[i].score);
        EXPECT_EQ(found[i].group_score, expected[i].group_score) << "to the last bit";
        EXPECT_EQ(found[i].group, expected[i].group);
      }
    }
  }
}

TEST_F(TwoRooms, AreNotFoundForAnUnknownView) {
  show(0, {0, 1});
  EXPECT_THAT(places({6, 7}), IsEmpty());
  EXPECT_THAT(places({}), IsEmpty());
}

}  // namespace
}  // namespace byre
