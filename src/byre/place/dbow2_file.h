#pragma once

#include "byre/place/vocabulary_file.h"

#include <filesystem>

namespace byre {

// Reads the text format of DBoW2: a line "k L scoring weighting", then per node except the root a line "parent is_leaf
// d0 .. d31 weight". Nodes are numbered in file order from 1; the root is 0. Weights are used unchanged; scoring and
// weighting are ignored, because byre has one scoring method. Throws InputError naming the line.
VocabularyTree read_dbow2(const std::filesystem::path& path);

}  // namespace byre
