#pragma once

#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"
#include "byre/slam/loops/finishing.h"
#include "byre/slam/system/slam_impl.h"

namespace byre {

// Repeats the final steps of mapping: loop search, adjustment of the whole map, removal of weak points and redundant
// keyframes. Afterwards poses count as estimated by SLAM, whatever their origin. Precondition: the map has words of the
// vocabulary.
FinishResult refine_map(StoredMap& stored, const Vocabulary& vocabulary, const FinishHooks& hooks,
                        const FinishOptions& options = {});

}  // namespace byre
