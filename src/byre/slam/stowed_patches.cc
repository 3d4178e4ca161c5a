#include "byre/slam/stowed_patches.h"

#include "byre/input/byte_stream.h"
#include "byre/map/map_quanta.h"
#include "byre/map/packed_steps.h"

#include <cstdint>
#include <optional>

namespace byre {
namespace {

// False where it would not be the same again.
bool pack(int feature, const Patch& patch, ByteWriter& writer) {
  const PatchCode code = patch_code(patch);
  const std::optional<Patch> again = patch_of(code);
  if (!again || again->pixels != patch.pixels || again->centre != patch.centre) return false;
  writer.write_varint(static_cast<std::uint32_t>(feature));
  writer.write(code.darkest);
  writer.write(code.brightest);
  writer.write_all<std::uint16_t>(code.centre);
  write_packed_steps(code.steps, writer);
  return true;
}

// Empty where one of the patches cannot be packed, or there are none.
std::vector<std::byte> packed(const Features& features) {
  ByteWriter writer;
  for (int i = 0; i < features.size(); ++i) {
    const Patch* const patch = features.find_patch(i);
    if (patch != nullptr && !pack(i, *patch, writer)) return {};
  }
  return writer.bytes();
}

Features with_patches(const Features& features, const std::vector<std::byte>& bytes) {
  std::vector<int> of_features;
  std::vector<Patch> patches;
  for (ByteReader reader(bytes, "patches", 0); reader.remaining() > 0;) {
    of_features.push_back(static_cast<int>(reader.read_varint()));
    PatchCode code;
    code.darkest = reader.read<std::uint8_t>();
    code.brightest = reader.read<std::uint8_t>();
    reader.read_all<std::uint16_t>(code.centre);
    code.steps = read_packed_steps(reader);
    patches.push_back(*patch_of(code));
  }
  return features.with_patches(of_features, std::move(patches));
}

}  // namespace

StowedPatches::StowedPatches(Map& map) {
  for (const KeyframeId id : map.keyframe_ids()) {
    const std::shared_ptr<const Features>& features = map.find_keyframe(id)->frame.features;
    std::vector<std::byte> bytes = features ? packed(*features) : std::vector<std::byte>{};
    if (bytes.empty()) continue;
    map.keep_patches(id, {});
    packed_.emplace_back(id, std::move(bytes));
  }
}

void StowedPatches::give_back(Map& map) {
  for (auto& [id, bytes] : packed_) {
    const Keyframe* const keyframe = map.find_keyframe(id);
    if (keyframe != nullptr) map.move_features(id, with_patches(*keyframe->frame.features, bytes));
    bytes = {};
  }
}

}  // namespace byre
