#pragma once

#include "byre/features.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace byre {

// The nodes of a vocabulary in breadth-first order, the root first: so the children of a node follow each other, and
// those of the next node come right after them.
struct VocabularyTree {
  std::vector<Descriptor> centres;         // one per node; the root's is zero
  std::vector<std::uint32_t> first_child;  // one per node, where its children begin; then the number of nodes
  std::vector<float> weights;              // one per word, that is, per leaf from left to right
};

// A VocabularyTree read where it lies, and what follows from it.
struct VocabularyView {
  std::span<const Descriptor> centres;
  std::span<const std::uint32_t> first_child;
  std::span<const float> weights;
  std::vector<std::uint32_t> first_word;  // one per node: the leftmost word below it; a leaf's own word
  int branching = 0;                      // most children of a node
  int depth = 0;                          // levels below the root
  std::uint64_t checksum = 0;             // checksum of the header, which holds those of centres, children and weights
};

// One per node: the number of leaves to the left of those below it. Precondition: as in VocabularyTree, and every node
// comes before its children.
std::vector<std::uint32_t> first_words(std::span<const std::uint32_t> first_child);

// The layout is described in docs/vocabulary_format.md. Equal trees give equal bytes.
std::vector<std::byte> write_vocabulary(const VocabularyTree& tree);

// Views into the bytes, which must begin at a multiple of 8 in memory. Throws InputError naming section and byte for
// any damage, and for a format that is newer than this program's. name: of the file, for messages.
VocabularyView read_vocabulary(std::span<const std::byte> bytes, const std::string& name);

}  // namespace byre
