#pragma once

#include "byre/tag.h"

#include <filesystem>
#include <vector>

namespace byre {

// Reads a YAML file of AprilTags, docs/how-to/use_apriltags.md. Throws InputError for an invalid file, and for a
// library without tag detection.
std::vector<Tag> read_tags(const std::filesystem::path& path);

}  // namespace byre
