#pragma once

#include "byre/features.h"
#include "byre/map/map.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace byre {

struct VocabularyTree;

// How often words occur in an image, weighted by how rare they are: sorted by word, weights sum to 1.
using BagOfWords = std::vector<std::pair<Word, float>>;

struct VocabularyOptions {
  int branching = 40;  // children of a node, 2 to 255
  int depth = 3;       // levels below the root, at most 16: at most branching^depth words
  int rounds = 10;     // rounds of clustering at each node, fewer when it settles
  std::uint64_t seed = 1;
};

// A tree of binary words (Nister and Stewenius 2006, Galvez-Lopez and Tardos 2012): a descriptor goes down from the
// root to the nearer child each time, and the leaf it ends in is its word. Words are numbered from left to right, so
// those below a node are a range. Constant; copies share their memory, which may be a file.
class Vocabulary {
 public:
  // Clusters by k-majority (Grana 2013) with k-means++ seeding; weights are the logarithms of the inverse document
  // frequency over the images. Deterministic. Throws InputError for fewer than two images or different descriptors, and
  // for options out of range. progress, unless empty, is called with the share done, 0 to 1.
  static Vocabulary train(std::span<const std::vector<Descriptor>> descriptors_of_images,
                          const VocabularyOptions& options, const std::function<void(double)>& progress = {});

  // A file that save wrote (docs/vocabulary_format.md), mapped into memory. Throws InputError naming section and byte
  // for any damage, a wrong checksum and a newer format.
  static Vocabulary load(const std::filesystem::path& path);
  void save(const std::filesystem::path& path) const;

  // The text format of DBoW2: "k L scoring weighting", then "parent is_leaf d0 .. d31 weight" per line.
  // Throws InputError naming the line.
  static Vocabulary import_dbow2(const std::filesystem::path& path);

  int word_count() const;
  int branching() const;
  int depth() const;
  std::uint64_t checksum() const;  // checksum of nodes and weights: equal for equal vocabularies

  Word word_of(const Descriptor& descriptor) const;
  std::vector<Word> words_of(const Features& features) const;
  float weight_of(Word word) const;  // how rare it is; zero beyond word_count()
  // tf-idf weights. Words beyond word_count(), and those of no weight, are left out.
  BagOfWords bag_of(std::span<const Word> words) const;

  // Words are similar when they share a node high up in the tree: the node above the word, levels_up levels above the
  // deepest leaves (0: the word itself, depth(): the root). Where leaves lie higher than that, the word itself. A node
  // is named by the first word below it, so that the result ascends with the word. Precondition: word < word_count().
  Word node_above(Word word, int levels_up) const;

 private:
  struct Data;
  explicit Vocabulary(std::shared_ptr<const Data> data);
  static Vocabulary of_tree(const VocabularyTree& tree);

  std::shared_ptr<const Data> data_;
};

// 1 - |a - b| / 2 in the L1 norm: 1 for equal bags, 0 for bags without a common word.
float similarity(const BagOfWords& a, const BagOfWords& b);

// The vocabulary that comes with byre: $BYRE_VOCABULARY if that is set, else the installed one, else the source tree's.
// Throws InputError when there is none.
std::filesystem::path default_vocabulary_path();

}  // namespace byre
