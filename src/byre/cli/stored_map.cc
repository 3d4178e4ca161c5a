#include "byre/cli/stored_map.h"

#include "byre/place/map_words.h"

namespace byre::cli {

namespace fs = std::filesystem;

Vocabulary open_vocabulary(const std::optional<fs::path>& path) {
  return Vocabulary::load(path ? *path : default_vocabulary_path());
}

SourceRecording describe_source(const fs::path& folder, const Recording& recording) {
  const fs::path whole = fs::weakly_canonical(folder);
  return {whole.filename().string(), recording.calibration(), recording.times().front(), recording.times().back()};
}

void save_for_use(StoredMap stored, const Vocabulary& vocabulary, const std::string& site, const fs::path& path) {
  stored.notes["software"] = "byre " BYRE_VERSION;
  if (!site.empty()) stored.notes["site"] = site;
  add_words(stored, vocabulary);
  save_map(stored, path);
}

}  // namespace byre::cli
