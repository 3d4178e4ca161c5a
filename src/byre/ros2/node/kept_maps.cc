#include "byre/ros2/node/kept_maps.h"

#include "byre/base/output_file.h"

namespace byre {

namespace fs = std::filesystem;

fs::path previous_map(const fs::path& map) {
  fs::path previous = map.parent_path() / map.stem();
  previous += ".previous";
  previous += map.extension();
  return previous;
}

void keep_as_previous(const fs::path& map) {
  if (content_of(map) == FileContent::map) link_or_copy(map, previous_map(map));
}

}  // namespace byre
