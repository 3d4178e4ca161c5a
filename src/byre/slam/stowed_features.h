#pragma once

#include "byre/features.h"
#include "byre/map/map.h"
#include "byre/workers/scratch_file.h"

#include <functional>
#include <memory>

namespace byre {

// Most features of a map are looked at seldom, and they take more memory than all else. Stowed ones lie in a file and
// are the same wherever they are looked at.

// The same features in the file; as they are where there is nothing that the file does not have, or where it has no
// room.
std::shared_ptr<const Features> stowed(const std::shared_ptr<const Features>& features, ScratchFile& file);

// Those of all keyframes that are not in the file yet.
void stow_features(Map& map, ScratchFile& file);

// The same question, for what looks at features of a whole map and asks now and then whether to stop: what it has
// looked at in the file leaves memory each time. The file outlives the question. Empty questions are answered with no.
std::function<bool()> forgetting_looks(const ScratchFile& file, std::function<bool()> should_stop);

}  // namespace byre
