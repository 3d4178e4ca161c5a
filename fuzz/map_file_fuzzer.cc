// Reads any bytes as a map file, which must be refused or be a valid map. A valid map must be written back unchanged.
// A map that can be read as a whole can also be read in parts on demand.

#include "byre/input_error.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/map_upkeep.h"
#include "byre/map/stored_map_scene.h"

#include <array>
#include <cstdint>
#include <cstdlib>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

// Reads all parts of a map on demand, as missions do. Returns whether that succeeded.
bool read_whole_map(std::span<const std::byte> bytes) {
  try {
    const auto read_at = [bytes](std::size_t offset, std::span<std::byte> into) {
      std::ranges::copy(bytes.subspan(offset, into.size()), into.begin());
    };
    const byre::StoredMap opened = byre::open_map(read_at, bytes.size(), "fuzz.byre");
    byre::find_faults(opened);
    for (const byre::KeyframeId id : opened.map.keyframe_ids()) opened.map.keyframe_header(id)->picture.jpeg();
    opened.map.visit_words([](byre::KeyframeId, std::span<const byre::Word>) {});
    return true;
  } catch (const byre::InputError&) {
    return false;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  const bool is_valid = read_whole_map(bytes);
  try {
    const byre::StoredMap map = byre::read_map(bytes, "fuzz.byre");
    if (!is_valid) std::abort();
    if (!byre::find_faults(map).empty()) std::abort();
    const byre::MapUpkeep upkeep = byre::read_upkeep(bytes, "fuzz.byre");
    const bool has_upkeep = byre::section_of({bytes.begin(), bytes.end()}, "upkeep").name == "upkeep";
    const byre::MapBytes again = has_upkeep ? byre::write_map(map, upkeep) : byre::write_map(map);
    if (!std::ranges::equal(again, bytes)) std::abort();
  } catch (const byre::InputError&) {
  }
  return 0;
}

// Mutations begin with a valid map, because random bytes never become one, and mostly get right checksums.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  if (size < byre::kHeaderSize) {
    static const byre::MapBytes without_plan = byre::write_map(byre::StoredMapScene(2, 4).stored());
    static const byre::MapBytes with_plan = byre::write_map(byre::StoredMapScene(2, 4).stored_with_plan());
    static const byre::MapBytes session = byre::write_map(byre::StoredMapScene(2, 4).stored(),
                                                          byre::upkeep_of_session(byre::StoredMapScene(2, 4).stored()));
    static const byre::MapBytes with_pictures =
        byre::write_map(byre::with_pictures(byre::StoredMapScene(2, 4).stored()));
    const std::array originals = {&without_plan, &with_plan, &session, &with_pictures};
    const byre::MapBytes& original = *originals[seed % originals.size()];
    size = std::min(original.size(), max_size);
    std::memcpy(data, original.data(), size);
  }
  size = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 5 == 0) return size;
  byre::MapBytes bytes(size);
  std::memcpy(bytes.data(), data, size);
  byre::refresh_checksums(bytes);
  std::memcpy(data, bytes.data(), size);
  return size;
}
