#pragma once

#include "byre/map/map_file.h"
#include "byre/recording.h"

#include <filesystem>
#include <optional>

namespace byre {

// Description of a recording for a map made from it. Contains no path, so that equal maps are equal.
SourceRecording describe_source(const std::filesystem::path& folder, const Recording& recording,
                                const std::optional<RefinedCalibration>& refined = {});

}  // namespace byre
