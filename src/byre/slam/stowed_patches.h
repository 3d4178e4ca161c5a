#pragma once

#include "byre/features.h"
#include "byre/input/scratch_file.h"
#include "byre/map/map.h"

#include <memory>

namespace byre {

// Most patches of a map are looked at seldom, and they take as much memory as all else that its keyframes see. Stowed
// ones lie in a file and are the same wherever they are looked at.

// The same features with their patches in the file; as they are where there are none, the file has them or
// has no room.
std::shared_ptr<const Features> with_stowed_patches(const std::shared_ptr<const Features>& features, ScratchFile& file);

// The patches of all keyframes that are not in the file yet.
void stow_patches(Map& map, ScratchFile& file);

}  // namespace byre
