#pragma once

#include "byre/features.h"
#include "byre/map/map_graph.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace byre {

struct VocabularyTree;

// tf-idf weights of an image's words, sorted by word; weights sum to 1.
using BagOfWords = std::vector<std::pair<Word, float>>;

struct VocabularyOptions {
  int branching = 40;  // children per node, 2 to 255
  int depth = 3;       // levels below the root, at most 16: at most branching^depth words
  int rounds = 10;     // clustering rounds per node; fewer if converged
  std::uint64_t seed = 1;
};

// Vocabulary tree of binary words (Nister and Stewenius 2006, Galvez-Lopez and Tardos 2012). A descriptor descends from
// the root to the nearest child; the leaf that it reaches is its word. Words are numbered from left to right, so that
// those below a node are contiguous. Immutable; copies share their memory, which may be a mapped file.
class Vocabulary {
 public:
  // Clusters by k-majority (Grana 2013) with k-means++ seeding. Weights are the logarithms of the inverse document
  // frequency over the images. Deterministic. Throws InputError for fewer than two images or distinct descriptors, and
  // for options out of range. progress, unless empty, is called with the completed share, 0 to 1.
  static Vocabulary train(std::span<const std::vector<Descriptor>> descriptors_of_images,
                          const VocabularyOptions& options, const std::function<void(double)>& progress = {});

  // Maps a file written by save() (docs/lab/vocabulary.md) into memory. Throws InputError naming section
  // and byte for damage, a wrong checksum or a newer format.
  static Vocabulary load(const std::filesystem::path& path);
  void save(const std::filesystem::path& path) const;

  // Reads the text format of DBoW2, see read_dbow2. Throws InputError naming the line.
  static Vocabulary import_dbow2(const std::filesystem::path& path);

  int word_count() const;
  int branching() const;
  int depth() const;
  std::uint64_t checksum() const;  // covers nodes and weights; equal for equal vocabularies

  Word word_of(const Descriptor& descriptor) const;
  std::vector<Word> words_of(const Features& features) const;
  float weight_of(Word word) const;  // inverse document frequency; zero beyond word_count()
  // tf-idf weights. Words beyond word_count() and words of zero weight are omitted.
  BagOfWords bag_of(std::span<const Word> words) const;

  // The ancestor of a word, levels_up levels above the deepest leaves (0: the word itself, depth(): the root); the word
  // itself if its leaf is higher. Descriptors with the same ancestor are similar. A node is identified by the first
  // word below it, so that the result is monotonic in the word. Precondition: word < word_count().
  Word node_above(Word word, int levels_up) const;

 private:
  struct Data;
  explicit Vocabulary(std::shared_ptr<const Data> data);
  static Vocabulary of_tree(const VocabularyTree& tree);

  std::shared_ptr<const Data> data_;
};

// 1 - |a - b| / 2 in the L1 norm: 1 for equal bags, 0 for bags without a common word.
float similarity(const BagOfWords& a, const BagOfWords& b);

// $BYRE_VOCABULARY if set, else the installed vocabulary, else the source tree's. Throws InputError if there is none.
std::filesystem::path default_vocabulary_path();

}  // namespace byre
