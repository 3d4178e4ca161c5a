#include "byre/node/kept_maps.h"

#include "byre/input_error.h"

#include <system_error>

namespace byre {

namespace fs = std::filesystem;

fs::path previous_map(const fs::path& map) {
  fs::path previous = map.parent_path() / map.stem();
  previous += ".previous";
  previous += map.extension();
  return previous;
}

void keep_as_previous(const fs::path& map) {
  if (!fs::exists(map)) return;
  const fs::path previous = previous_map(map);
  fs::path unfinished = previous;
  unfinished += ".unfinished";
  std::error_code error;
  fs::remove(unfinished, error);
  fs::create_hard_link(map, unfinished, error);
  if (error) fs::copy_file(map, unfinished, error);  // a file system without links
  if (!error) fs::rename(unfinished, previous, error);
  if (!error) {
    // Where both are one file already, as after an interrupted save, nothing is renamed.
    fs::remove(unfinished, error);
    return;
  }
  throw InputError(previous.string(), "cannot be written (" + error.message() + ")",
                   "make space, or save into a folder that may be written to");
}

}  // namespace byre
