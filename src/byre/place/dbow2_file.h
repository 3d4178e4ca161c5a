#pragma once

#include "byre/place/vocabulary_file.h"

#include <filesystem>

namespace byre {

// Reads the text format of DBoW2: a line "k L scoring weighting", then a line for each node but the root, "parent
// is_leaf d0 .. d31 weight". Nodes are numbered as they come, from 1; the root is 0. The weights are taken as they are;
// scoring and weighting are of no further use, for byre has one way to score. Throws InputError naming the line.
VocabularyTree read_dbow2(const std::filesystem::path& path);

}  // namespace byre
