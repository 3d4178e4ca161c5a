#include "byre/slam/stowed_patches.h"

namespace byre {

std::shared_ptr<const Features> with_stowed_patches(const std::shared_ptr<const Features>& features,
                                                    ScratchFile& file) {
  if (!features || features->patches().empty() || file.holds(features->patches().data())) return features;
  const std::shared_ptr<const std::byte> piece = file.put(std::as_bytes(features->patches()));
  if (!piece) return features;
  const std::shared_ptr<const Patch> patches(piece, reinterpret_cast<const Patch*>(piece.get()));
  return std::make_shared<const Features>(features->with_patches_at(patches));
}

void stow_patches(Map& map, ScratchFile& file) {
  for (const KeyframeId id : map.keyframe_ids()) {
    map.replace_features(id, with_stowed_patches(map.find_keyframe(id)->frame.features, file));
  }
}

}  // namespace byre
