#pragma once

#include "byre/place/vocabulary.h"
#include "byre/place/vocabulary_file.h"

namespace byre {

// Implements Vocabulary::train.
VocabularyTree train_tree(std::span<const std::vector<Descriptor>> descriptors_of_images,
                          const VocabularyOptions& options, const std::function<void(double)>& progress);

}  // namespace byre
