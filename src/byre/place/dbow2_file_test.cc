#include "byre/place/dbow2_file.h"

#include "byre/input_error.h"
#include "byre/place/vocabulary.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;
using testing::FloatEq;
using testing::HasSubstr;
using testing::Pair;

// Line of a node whose descriptor has the given byte at index 0, 255 at index 31, and zeros between.
std::string node(int parent, int is_leaf, int first_byte, const std::string& weight) {
  std::string line = std::to_string(parent) + " " + std::to_string(is_leaf) + " " + std::to_string(first_byte);
  for (int i = 1; i < 31; ++i) line += " 0";
  return line + " 255 " + weight + "\n";
}

Descriptor descriptor(std::uint64_t first_byte) {
  return {first_byte, 0, 0, std::uint64_t{255} << 56};
}

// The order of DBoW2's writer: siblings are adjacent, levels are not.
//   root - 1 (leaf), 2, 3;  2 - 6, 7 (leaves);  3 - 4, 5 (leaves)
const std::string kNodes = node(0, 1, 1, "0.5") + node(0, 0, 14, "0") + node(0, 0, 224, "0") + node(3, 1, 96, "4") +
                           node(3, 1, 192, "8.25") + node(2, 1, 6, "1") + node(2, 1, 12, "2e0");

class Dbow2File : public testing::Test {
 protected:
  ~Dbow2File() override { fs::remove(path_); }

  void write(const std::string& text) const { std::ofstream(path_) << text; }

  std::string refusal_of(const std::string& text) const {
    write(text);
    try {
      read_dbow2(path_);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(path_.string().size());
    }
    return "no InputError";
  }

  const fs::path path_ = fs::path(testing::TempDir()) / ("byre_dbow2_" + std::to_string(getpid()) + ".txt");
};

TEST_F(Dbow2File, IsReadInBreadthFirstOrder) {
  write("3 2 0 0\n" + kNodes);
  const VocabularyTree tree = read_dbow2(path_);
  EXPECT_THAT(tree.first_child, ElementsAre(1, 4, 4, 6, 8, 8, 8, 8, 8));
  EXPECT_THAT(tree.centres, ElementsAre(Descriptor{}, descriptor(1), descriptor(14), descriptor(224), descriptor(6),
                                        descriptor(12), descriptor(96), descriptor(192)));
  EXPECT_THAT(tree.weights, ElementsAre(0.5f, 1.0f, 2.0f, 4.0f, 8.25f));
}

TEST_F(Dbow2File, ConvertsToAVocabulary) {
  write("3 2 0 0\r\n" + kNodes);
  const Vocabulary vocabulary = Vocabulary::import_dbow2(path_);
  EXPECT_EQ(vocabulary.word_count(), 5);
  EXPECT_EQ(vocabulary.branching(), 3);
  EXPECT_EQ(vocabulary.depth(), 2);
  EXPECT_EQ(vocabulary.word_of(descriptor(1)), 0u);
  EXPECT_EQ(vocabulary.word_of(descriptor(6)), 1u);
  EXPECT_EQ(vocabulary.word_of(descriptor(12)), 2u);
  EXPECT_EQ(vocabulary.word_of(descriptor(96)), 3u);
  EXPECT_EQ(vocabulary.word_of(descriptor(192)), 4u);
  EXPECT_EQ(vocabulary.node_above(4, 1), 3u);
  EXPECT_EQ(vocabulary.node_above(0, 1), 0u) << "a leaf above the requested level represents itself";
  const std::vector<Word> words = {4, 1, 1};
  EXPECT_THAT(vocabulary.bag_of(words),
              ElementsAre(Pair(1u, FloatEq(2.0f / 10.25f)), Pair(4u, FloatEq(8.25f / 10.25f))));
}

TEST_F(Dbow2File, AcceptsScatteredSiblings) {
  write("2 2 0 0\n" + node(0, 0, 1, "0") + node(0, 0, 2, "0") + node(1, 1, 3, "1") + node(2, 1, 4, "2") +
        node(1, 1, 5, "3") + node(2, 1, 6, "4"));
  const VocabularyTree tree = read_dbow2(path_);
  EXPECT_THAT(tree.weights, ElementsAre(1.0f, 3.0f, 2.0f, 4.0f));
  EXPECT_THAT(tree.first_child, ElementsAre(1, 3, 5, 7, 7, 7, 7, 7));
}

TEST_F(Dbow2File, ReportsTheLineOfAMalformedHeader) {
  EXPECT_THAT(refusal_of("10 6 0\n" + kNodes), HasSubstr(":1: has 3 fields instead of k, L, scoring, weighting"));
  EXPECT_THAT(refusal_of("1 6 0 0\n" + kNodes), HasSubstr(":1: the branching k is \"1\""));
  EXPECT_THAT(refusal_of("10 six 0 0\n" + kNodes), HasSubstr(":1: the depth L is \"six\""));
  EXPECT_THAT(refusal_of("10 6 9 0\n" + kNodes), HasSubstr(":1: the scoring is \"9\""));
  EXPECT_THAT(refusal_of("10 6 0 -1\n" + kNodes), HasSubstr(":1: the weighting is \"-1\""));
  EXPECT_THAT(refusal_of("10 6 0 0\n"), HasSubstr("has no nodes"));
  EXPECT_THAT(refusal_of(""), HasSubstr("has no nodes"));
}

TEST_F(Dbow2File, ReportsTheLineOfAMalformedNode) {
  const std::string header = "3 2 0 0\n" + node(0, 1, 1, "1");
  EXPECT_THAT(refusal_of(header + "0 1 2 3\n"), HasSubstr(":3: has 4 fields instead of 35"));
  EXPECT_THAT(refusal_of(header + node(0, 1, 256, "1")), HasSubstr(":3: a byte of the descriptor is \"256\""));
  EXPECT_THAT(refusal_of(header + node(0, 2, 1, "1")), HasSubstr(":3: is_leaf is \"2\""));
  EXPECT_THAT(refusal_of(header + node(2, 1, 1, "1")), HasSubstr(":3: the parent is \"2\""));
  EXPECT_THAT(refusal_of(header + node(-1, 1, 1, "1")), HasSubstr(":3: the parent is \"-1\""));
  EXPECT_THAT(refusal_of(header + node(0, 1, 1, "-1")), HasSubstr(":3: the weight is \"-1\""));
  EXPECT_THAT(refusal_of(header + node(0, 1, 1, "nan")), HasSubstr(":3: the weight is \"nan\""));
  EXPECT_THAT(refusal_of(header + node(0, 1, 1, "1e300")), HasSubstr(":3: the weight is \"1e300\""));
}

TEST_F(Dbow2File, ReportsTheLineOfAnInconsistentNode) {
  EXPECT_THAT(refusal_of("3 2 0 0\n" + node(0, 1, 1, "1") + node(1, 1, 2, "1")),
              HasSubstr(":2: node 1 is marked as a leaf but has children"));
  EXPECT_THAT(refusal_of("3 2 0 0\n" + node(0, 1, 1, "1") + node(0, 0, 2, "1")),
              HasSubstr(":3: node 2 has no children but is not marked as a leaf"));
  EXPECT_THAT(refusal_of("3 1 0 0\n" + node(0, 0, 1, "1") + node(1, 1, 2, "1")),
              HasSubstr(":3: node 2 is deeper than L"));
  EXPECT_THAT(refusal_of("2 1 0 0\n" + node(0, 1, 1, "1") + node(0, 1, 2, "1") + node(0, 1, 3, "1")),
              HasSubstr(":1: node 0 has more than k children"));
}

TEST_F(Dbow2File, IsReportedIfUnreadable) {
  EXPECT_THROW(read_dbow2("/absent/vocabulary.txt"), InputError);
}

}  // namespace
}  // namespace byre
