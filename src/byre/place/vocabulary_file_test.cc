#include "byre/place/vocabulary_file.h"

#include "byre/base/binary_file.h"
#include "byre/input_error.h"
#include "byre/place/vocabulary.h"
#include "byre/place/vocabulary_scene.h"

#include <cstring>
#include <filesystem>
#include <limits>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// Children of the root: a leaf, a node with two leaves, a leaf.
VocabularyTree tree_of_two_levels() {
  VocabularyTree tree;
  tree.centres = {{}, {1, 2, 3, 4}, {5}, {6}, {7}, {8}};
  tree.first_child = {1, 4, 4, 6, 6, 6, 6};
  tree.weights = {0.5f, 1.0f, 2.0f, 4.0f};
  return tree;
}

std::string damage_in(std::span<const std::byte> bytes) {
  try {
    read_vocabulary(bytes, "some.vocabulary");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

std::string damage_in(const VocabularyTree& tree) {
  return damage_in(write_vocabulary(tree));
}

void put(std::vector<std::byte>& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
}

TEST(VocabularyFile, ReadsBackWhatItWrites) {
  const VocabularyTree tree = tree_of_two_levels();
  const std::vector<std::byte> bytes = write_vocabulary(tree);
  const VocabularyView view = read_vocabulary(bytes, "some.vocabulary");
  EXPECT_THAT(view.centres, testing::ElementsAreArray(tree.centres));
  EXPECT_THAT(view.first_child, testing::ElementsAreArray(tree.first_child));
  EXPECT_THAT(view.weights, testing::ElementsAreArray(tree.weights));
  EXPECT_EQ(view.branching, 3);
  EXPECT_EQ(view.depth, 2);
}

TEST(VocabularyFile, NumbersWordsFromLeftToRight) {
  EXPECT_THAT(first_words(tree_of_two_levels().first_child), ElementsAre(0, 0, 1, 3, 1, 2));
}

TEST(VocabularyFile, HasTheDocumentedLayout) {
  const std::vector<std::byte> bytes = write_vocabulary(tree_of_two_levels());
  ASSERT_EQ(bytes.size(), 64u + 6 * 32 + 7 * 4 + 4 * 4);
  EXPECT_EQ(std::memcmp(bytes.data(), "byrevoc\n\1\0\0\0\6\0\0\0\4\0\0\0\0\0\0\0", 24), 0);
  EXPECT_EQ(std::memcmp(bytes.data() + 64 + 32, "\1\0\0\0\0\0\0\0\2", 9), 0);             // centre of node 1
  EXPECT_EQ(std::memcmp(bytes.data() + 64 + 6 * 32, "\1\0\0\0\4\0\0\0\4\0\0\0", 12), 0);  // first children
}

TEST(VocabularyFile, HasADistinctChecksumPerVocabulary) {
  const auto checksum_of = [](const VocabularyTree& tree) {
    return read_vocabulary(write_vocabulary(tree), "").checksum;
  };
  VocabularyTree other = tree_of_two_levels();
  EXPECT_EQ(checksum_of(other), checksum_of(tree_of_two_levels()));
  other.weights[3] = 4.5f;
  EXPECT_NE(checksum_of(other), checksum_of(tree_of_two_levels()));
  other = tree_of_two_levels();
  other.centres[5][3] ^= 1;
  EXPECT_NE(checksum_of(other), checksum_of(tree_of_two_levels()));
}

TEST(VocabularyFile, DetectsEveryFlippedBit) {
  std::vector<std::byte> bytes = write_vocabulary(tree_of_two_levels());
  for (std::size_t i = 0; i < bytes.size() * 8; ++i) {
    const std::byte mask{static_cast<unsigned char>(1 << i % 8)};
    bytes[i / 8] ^= mask;
    EXPECT_THAT(damage_in(bytes), StartsWith("some.vocabulary: section ")) << "bit " << i;
    bytes[i / 8] ^= mask;
  }
}

TEST(VocabularyFile, DetectsEveryWrongLength) {
  std::vector<std::byte> bytes = write_vocabulary(tree_of_two_levels());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THAT(damage_in(std::span(bytes).first(size)), StartsWith("some.vocabulary: section ")) << size;
  }
  bytes.emplace_back();
  EXPECT_THAT(damage_in(bytes), HasSubstr("section weights at byte 300: is not at the end of the file"));
}

TEST(VocabularyFile, ReportsSectionAndByte) {
  std::vector<std::byte> bytes = write_vocabulary(tree_of_two_levels());
  bytes[70] ^= std::byte{1};
  EXPECT_THAT(damage_in(bytes), HasSubstr("section centres at byte 64: does not have the checksum"));
  bytes = write_vocabulary(tree_of_two_levels());
  EXPECT_THAT(damage_in(std::span(bytes).first(260)), HasSubstr("section children at byte 260: ends too early"));
  EXPECT_THAT(damage_in(std::span(bytes).first(20)), HasSubstr("section header at byte 20: ends too early"));
}

TEST(VocabularyFile, DistinguishesOtherFormatsFromDamage) {
  std::vector<std::byte> bytes = write_vocabulary(tree_of_two_levels());
  put(bytes, 8, 2);
  EXPECT_THAT(damage_in(bytes), HasSubstr("has format 2; this program reads format 1"));
  const std::string text = "10 6 0 0\n0 1 17";
  EXPECT_THAT(damage_in(std::as_bytes(std::span(text))), HasSubstr("\"byre vocabulary import\""));
}

// A file with correct checksums may still be invalid.
TEST(VocabularyFile, RejectsInvalidTrees) {
  VocabularyTree tree = tree_of_two_levels();
  tree.first_child = {1, 4, 4, 6, 5, 6, 6};  // descending
  EXPECT_THAT(damage_in(tree), HasSubstr("section children at byte 268: has invalid children of node 3"));
  tree.first_child = {1, 1, 1, 1, 1, 1, 6};  // node 5 is its own child
  EXPECT_THAT(damage_in(tree), HasSubstr("has invalid children of node 5"));
  tree.first_child = {0, 4, 4, 6, 6, 6, 6};
  EXPECT_THAT(damage_in(tree), HasSubstr("section children at byte 256: the children of the root"));
  tree.first_child = {1, 4, 4, 5, 5, 5, 5};
  EXPECT_THAT(damage_in(tree), HasSubstr("section children at byte 280: has nodes without parent"));
  tree.first_child = {1, 4, 4, 4000, 4000, 4000, 4000};
  EXPECT_THAT(damage_in(tree), HasSubstr("has invalid children of node 2"));
}

TEST(VocabularyFile, RejectsInvalidWeights) {
  for (const float weight : {-1.0f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    VocabularyTree tree = tree_of_two_levels();
    tree.weights[2] = weight;
    EXPECT_THAT(damage_in(tree), HasSubstr("section weights at byte 292: word 2 has no valid weight"));
  }
  VocabularyTree tree = tree_of_two_levels();
  tree.weights.push_back(1.0f);
  EXPECT_THAT(damage_in(tree), HasSubstr("has a number of weights other than the number of words"));
}

TEST(VocabularyFile, RejectsAVocabularyWithoutWords) {
  EXPECT_THAT(damage_in(VocabularyTree{{{}}, {1, 1}, {1.0f}}), HasSubstr("has no word"));
  EXPECT_THAT(damage_in(VocabularyTree{{}, {1}, {}}), HasSubstr("has no word"));
}

TEST(VocabularyFile, IsUnchangedBySavingAndLoading) {
  const fs::path path = fs::path(testing::TempDir()) / ("byre_saved_" + std::to_string(getpid()) + ".vocabulary");
  const std::vector<Descriptor> centres = random_descriptors(20, 1);
  const Vocabulary trained = Vocabulary::train(noisy_images(centres, 3, 4, 10, 2), {});
  trained.save(path);
  const Vocabulary loaded = Vocabulary::load(path);
  fs::remove(path);
  EXPECT_EQ(loaded.checksum(), trained.checksum());
  EXPECT_EQ(loaded.word_count(), trained.word_count());
  for (const Descriptor& descriptor : centres) EXPECT_EQ(loaded.word_of(descriptor), trained.word_of(descriptor));
}

TEST(VocabularyFile, IsReportedIfUnreadable) {
  EXPECT_THROW(Vocabulary::load("/absent/some.vocabulary"), InputError);
  EXPECT_THROW(Vocabulary::load(testing::TempDir()), InputError);
}

}  // namespace
}  // namespace byre
