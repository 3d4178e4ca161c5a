#pragma once

#include "byre/base/scratch_file.h"
#include "byre/features.h"
#include "byre/map/map_graph.h"

#include <functional>
#include <memory>

namespace byre {

// Features take most of the memory of a map, and most are read seldom. Paged-out features are in a file; access to them
// is unchanged.

// The same features in the file. Unchanged if the file has all of them, or no room.
std::shared_ptr<const Features> page_out(const std::shared_ptr<const Features>& features, ScratchFile& file);

// Pages out the features of all keyframes that are not in the file yet.
void page_out_features(MapGraph& map, ScratchFile& file);

// Wraps should_stop for jobs that read features of a whole map and poll it: each call also releases the memory of the
// features read from the file. The file must outlive the result. An empty should_stop counts as false.
std::function<bool()> releasing_pages(const ScratchFile& file, std::function<bool()> should_stop);

}  // namespace byre
