#include "byre/place/vocabulary.h"

#include "byre/input_error.h"
#include "byre/place/vocabulary_scene.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::FloatEq;
using testing::FloatNear;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

constexpr int kFamilies = 4;
constexpr int kMembers = 4;
constexpr int kNoise = 1;  // bits; much less than the distance between members of a family

VocabularyOptions small_tree() {
  VocabularyOptions options;
  options.branching = 4;
  options.depth = 2;
  return options;
}

// Vocabulary of five images with four families of four descriptors, which a tree of branching 4 and depth 2 separates.
class TrainedVocabulary : public testing::Test {
 protected:
  const std::vector<Descriptor> centres = descriptor_families(kFamilies, kMembers, 1);
  const std::vector<std::vector<Descriptor>> images = noisy_images(centres, 5, 10, kNoise, 2);
  const Vocabulary vocabulary = Vocabulary::train(images, small_tree());
};

std::vector<Word> words_of(const Vocabulary& vocabulary, std::span<const Descriptor> descriptors) {
  std::vector<Word> words;
  for (const Descriptor& descriptor : descriptors) words.push_back(vocabulary.word_of(descriptor));
  return words;
}

std::string refusal(const std::vector<std::vector<Descriptor>>& images, const VocabularyOptions& options) {
  try {
    Vocabulary::train(images, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

TEST_F(TrainedVocabulary, HasTheRequestedShape) {
  EXPECT_EQ(vocabulary.branching(), 4);
  EXPECT_EQ(vocabulary.depth(), 2);
  EXPECT_EQ(vocabulary.word_count(), kFamilies * kMembers);
}

TEST_F(TrainedVocabulary, AssignsOneWordToNoisyViews) {
  std::mt19937_64 random(3);
  for (const Descriptor& centre : centres) {
    const Word word = vocabulary.word_of(centre);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(vocabulary.word_of(with_noise(centre, kNoise, random)), word);
  }
}

TEST_F(TrainedVocabulary, AssignsDifferentWordsToDifferentFeatures) {
  const std::vector<Word> words = words_of(vocabulary, centres);
  EXPECT_EQ(std::set<Word>(words.begin(), words.end()).size(), centres.size());
}

TEST_F(TrainedVocabulary, GroupsSimilarFeaturesBelowOneNode) {
  std::set<Word> nodes;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const Word node = vocabulary.node_above(vocabulary.word_of(centres[i]), 1);
    EXPECT_EQ(node, vocabulary.node_above(vocabulary.word_of(centres[i / kMembers * kMembers]), 1));
    nodes.insert(node);
  }
  EXPECT_EQ(nodes.size(), static_cast<std::size_t>(kFamilies));
}

TEST_F(TrainedVocabulary, AssignsWordsToAllFeaturesOfAnImage) {
  const Features features(640, 480, std::vector<Keypoint>(centres.size(), Keypoint{{1.0f, 1.0f}}), centres, {});
  EXPECT_EQ(vocabulary.words_of(features), words_of(vocabulary, to_vector(features.descriptors())));
}

TEST_F(TrainedVocabulary, DependsOnTheSeed) {
  EXPECT_EQ(Vocabulary::train(images, small_tree()).checksum(), vocabulary.checksum());
  VocabularyOptions other = small_tree();
  other.seed = 2;
  EXPECT_NE(Vocabulary::train(images, other).checksum(), vocabulary.checksum());
}

TEST_F(TrainedVocabulary, ReportsProgress) {
  std::vector<double> shares;
  Vocabulary::train(images, small_tree(), [&shares](double share) { shares.push_back(share); });
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_GT(shares.size(), 3u);
  EXPECT_DOUBLE_EQ(shares.back(), 1.0);
}

TEST_F(TrainedVocabulary, ReturnsTheNodesAboveAWord) {
  std::set<Word> nodes;
  Word before = 0;
  for (Word word = 0; word < static_cast<Word>(vocabulary.word_count()); ++word) {
    EXPECT_EQ(vocabulary.node_above(word, 0), word);
    EXPECT_EQ(vocabulary.node_above(word, 2), 0u);
    const Word node = vocabulary.node_above(word, 1);
    EXPECT_LE(node, word);
    EXPECT_GE(node, before);
    EXPECT_EQ(vocabulary.node_above(node, 1), node);
    before = node;
    nodes.insert(node);
  }
  EXPECT_EQ(nodes.size(), static_cast<std::size_t>(kFamilies));
}

TEST(Training, WeightsWordsByInverseImageFrequency) {
  const std::vector<Descriptor> centres = random_descriptors(3, 4);
  const std::vector<std::vector<Descriptor>> images = {
      {centres[0], centres[1], centres[2], centres[2]}, {centres[0], centres[1]}, {centres[0], centres[0]}, {}};
  VocabularyOptions options;
  options.depth = 1;
  const Vocabulary vocabulary = Vocabulary::train(images, options);
  ASSERT_EQ(vocabulary.word_count(), 3);
  const std::vector<Word> words = words_of(vocabulary, centres);

  // The first word is in three of the four images, the second in two, the third in one.
  const float sum = std::log(4.0f / 3.0f) + std::log(2.0f) + std::log(4.0f);
  for (const auto& [word, weight] : vocabulary.bag_of(words)) {
    const float images_with_word = word == words[0] ? 3.0f : word == words[1] ? 2.0f : 1.0f;
    EXPECT_THAT(weight, FloatNear(std::log(4.0f / images_with_word) / sum, 1e-6f));
  }
}

TEST(Training, CountsImagesByTheFinishedTree) {
  std::vector<std::vector<Descriptor>> images;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) images.push_back(random_descriptors(80, seed));
  VocabularyOptions options;
  options.branching = 3;
  options.depth = 3;
  options.rounds = 1;  // stops before clusters converge
  const Vocabulary vocabulary = Vocabulary::train(images, options);

  std::vector<std::set<Word>> words_of_images;
  for (const auto& image : images) {
    const std::vector<Word> words = words_of(vocabulary, image);
    words_of_images.emplace_back(words.begin(), words.end());
  }
  std::vector<double> weights;
  double sum = 0.0;
  std::vector<Word> all;
  for (Word word = 0; word < static_cast<Word>(vocabulary.word_count()); ++word) {
    const auto count =
        std::ranges::count_if(words_of_images, [word](const auto& words) { return words.contains(word); });
    ASSERT_GT(count, 0);
    weights.push_back(std::log(6.0 / static_cast<double>(count)));
    sum += weights.back();
    all.push_back(word);
  }
  for (const auto& [word, weight] : vocabulary.bag_of(all)) EXPECT_NEAR(weight, weights[word] / sum, 1e-6);
}

TEST(Training, MakesShallowLeavesOfIndivisibleNodes) {
  const std::vector<Descriptor> centres = random_descriptors(3, 5);
  VocabularyOptions options;
  options.depth = 6;
  const Vocabulary vocabulary = Vocabulary::train(noisy_images(centres, 3, 5, 0, 6), options);
  EXPECT_EQ(vocabulary.word_count(), 3);
  EXPECT_EQ(vocabulary.depth(), 1);
}

TEST(Training, RejectsInsufficientImages) {
  const std::vector<Descriptor> some = random_descriptors(10, 7);
  EXPECT_THAT(refusal({}, {}), HasSubstr("fewer than two training images"));
  EXPECT_THAT(refusal({some}, {}), HasSubstr("fewer than two training images"));
  EXPECT_THAT(refusal({{}, {}}, {}), HasSubstr("fewer than two different descriptors"));
  EXPECT_THAT(refusal({{some[0], some[0]}, {some[0]}}, {}), HasSubstr("fewer than two different descriptors"));
}

TEST(Training, RejectsOptionsOutOfRange) {
  const std::vector<std::vector<Descriptor>> images(2, random_descriptors(10, 8));
  VocabularyOptions options;
  options.branching = 256;
  EXPECT_THAT(refusal(images, options), HasSubstr("branching: is 256 (choose 2 to 255)"));
  options = {};
  options.depth = 0;
  EXPECT_THAT(refusal(images, options), HasSubstr("depth: is 0"));
  options = {};
  options.rounds = 0;
  EXPECT_THAT(refusal(images, options), HasSubstr("rounds: is 0"));
}

TEST_F(TrainedVocabulary, ReturnsSortedBagsThatSumToOne) {
  // Every word of this vocabulary is in every image and has zero weight, so the images get different words.
  std::vector<std::vector<Descriptor>> different(centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) different[i] = {centres[i], centres[(i + 1) % centres.size()]};
  const Vocabulary weighted = Vocabulary::train(different, small_tree());
  const std::vector<Word> words = words_of(weighted, centres);
  const BagOfWords bag = weighted.bag_of(words);
  float sum = 0.0f;
  for (std::size_t i = 0; i < bag.size(); ++i) {
    sum += bag[i].second;
    EXPECT_TRUE(i == 0 || bag[i - 1].first < bag[i].first);
  }
  EXPECT_THAT(sum, FloatNear(1.0f, 1e-6f));
  EXPECT_EQ(bag.size(), std::set<Word>(words.begin(), words.end()).size());
}

TEST_F(TrainedVocabulary, OmitsUnknownAndUbiquitousWords) {
  const std::vector<Word> words = words_of(vocabulary, centres);
  EXPECT_THAT(vocabulary.bag_of(words), IsEmpty());
  const std::vector<Word> unknown = {static_cast<Word>(vocabulary.word_count()), 4'000'000'000u};
  EXPECT_THAT(vocabulary.bag_of(unknown), IsEmpty());
  EXPECT_THAT(vocabulary.bag_of({}), IsEmpty());
}

TEST(BagOfWordsTest, CountsRepeatedWords) {
  const std::vector<Descriptor> centres = random_descriptors(2, 9);
  VocabularyOptions options;
  options.depth = 1;
  const Vocabulary vocabulary =
      Vocabulary::train(std::vector<std::vector<Descriptor>>{{centres[0]}, {centres[1]}}, options);
  const std::vector<Word> words = {1, 0, 1, 1};
  EXPECT_THAT(vocabulary.bag_of(words), ElementsAre(Pair(0u, FloatEq(0.25f)), Pair(1u, FloatEq(0.75f))));
}

TEST(Similarity, IsOneForEqualBagsAndZeroForDisjointOnes) {
  const BagOfWords a = {{1, 0.25f}, {5, 0.75f}};
  const BagOfWords b = {{2, 0.5f}, {9, 0.5f}};
  EXPECT_FLOAT_EQ(similarity(a, a), 1.0f);
  EXPECT_FLOAT_EQ(similarity(a, b), 0.0f);
  EXPECT_FLOAT_EQ(similarity(a, {}), 0.0f);
  EXPECT_FLOAT_EQ(similarity({}, {}), 0.0f);
}

TEST(Similarity, IsSymmetricAndOneMinusHalfTheL1Distance) {
  const BagOfWords a = {{1, 0.25f}, {5, 0.5f}, {7, 0.25f}};
  const BagOfWords b = {{0, 0.1f}, {1, 0.6f}, {7, 0.3f}};
  const float distance = 0.1f + 0.35f + 0.5f + 0.05f;
  EXPECT_FLOAT_EQ(similarity(a, b), 1.0f - distance / 2.0f);
  EXPECT_FLOAT_EQ(similarity(b, a), similarity(a, b));
}

}  // namespace
}  // namespace byre
