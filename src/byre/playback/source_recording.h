#pragma once

#include "byre/map/map_file.h"
#include "byre/recording.h"

#include <filesystem>
#include <optional>

namespace byre {

// What a map says of a recording it was made from: not where it lies, so that equal maps are equal.
SourceRecording describe_source(const std::filesystem::path& folder, const Recording& recording,
                                const std::optional<RefinedCalibration>& refined = {});

}  // namespace byre
