#pragma once

#include "byre/features.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace byre {

// Nodes of a vocabulary in breadth-first order from the root; children of consecutive nodes are consecutive.
struct VocabularyTree {
  std::vector<Descriptor> centres;         // one per node; the root's is zero
  std::vector<std::uint32_t> first_child;  // one per node: index of its first child; then the number of nodes
  std::vector<float> weights;              // one per word, which are the leaves from left to right
};

// A VocabularyTree as views into a file's bytes, with derived values.
struct VocabularyView {
  std::span<const Descriptor> centres;
  std::span<const std::uint32_t> first_child;
  std::span<const float> weights;
  std::vector<std::uint32_t> first_word;  // one per node: the leftmost word below it; for a leaf its own
  int branching = 0;                      // largest number of children of a node
  int depth = 0;                          // levels below the root
  std::uint64_t checksum = 0;  // checksum of the header, which contains the checksums of centres, children and weights
};

// One per node: the number of leaves left of its subtree. Precondition: as in VocabularyTree, nodes before children.
std::vector<std::uint32_t> first_words(std::span<const std::uint32_t> first_child);

// Format: docs/lab/vocabulary.md. Equal trees give equal bytes.
std::vector<std::byte> write_vocabulary(const VocabularyTree& tree);

// Views into the bytes, which must be aligned to 8. Throws InputError naming section and byte for damage or a newer
// format. name: in messages.
VocabularyView read_vocabulary(std::span<const std::byte> bytes, const std::string& name);

}  // namespace byre
