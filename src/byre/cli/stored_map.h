#pragma once

#include "byre/dataset/recording.h"
#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"

#include <filesystem>
#include <optional>
#include <string>

namespace byre::cli {

// The vocabulary of a file, or the one that comes with byre. Throws InputError when it cannot be loaded.
Vocabulary open_vocabulary(const std::optional<std::filesystem::path>& path);

// What a map says of a recording it was made from: not where it lies, so that equal maps are equal.
SourceRecording describe_source(const std::filesystem::path& folder, const Recording& recording);

// Saves the map with what later missions need beside it: words of the vocabulary, the site's name unless it is empty,
// and the version of byre.
void save_for_use(StoredMap stored, const Vocabulary& vocabulary, const std::string& site,
                  const std::filesystem::path& path);

}  // namespace byre::cli
