#include "byre/system/stored_map.h"

#include "byre/input_error.h"
#include "byre/place/map_words.h"

#include <utility>

namespace byre {

namespace fs = std::filesystem;

Vocabulary open_vocabulary(const std::optional<fs::path>& path) {
  return Vocabulary::load(path ? *path : default_vocabulary_path());
}

StoredMap load_for_mapping(const fs::path& path, const Vocabulary& vocabulary) {
  StoredMap stored = load_map(path);
  if (stored.scale != MapScale::metric) {
    throw InputError(path.string(), "has no metric scale, so nothing can be measured on it",
                     "give it one: byre scale, or --scale when importing a model");
  }
  if (stored.map.keyframe_count() == 0) throw InputError(path.string(), "holds no keyframes", "map a recording first");
  add_words(stored, vocabulary);
  return stored;
}

std::shared_ptr<const OfflineMap> load_offline_map(const fs::path& path, const Vocabulary& vocabulary) {
  StoredMap stored = load_for_mapping(path, vocabulary);
  return std::make_shared<const OfflineMap>(std::move(stored.map), vocabulary, std::move(stored.recordings));
}

std::vector<int> keyframes_of_recordings(const Map& map, std::size_t recordings) {
  std::vector<int> counts(recordings, 0);
  for (const KeyframeId id : map.keyframe_ids())
    ++counts.at(static_cast<std::size_t>(map.find_keyframe(id)->recording));
  return counts;
}

void save_for_use(StoredMap stored, const Vocabulary& vocabulary, const std::string& site, const fs::path& path) {
  stored.notes["software"] = "byre " BYRE_VERSION;
  if (!site.empty()) stored.notes["site"] = site;
  add_words(stored, vocabulary);
  save_map(stored, path);
}

}  // namespace byre
