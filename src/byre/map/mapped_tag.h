#pragma once

#include "byre/geometry/tag_pose.h"
#include "byre/map/map_file.h"
#include "byre/motion_warning.h"
#include "byre/tag.h"

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// Unit of length of a map by each tag with a size in `tags` whose views determine it, see estimate_unit.
std::map<TagId, UnitEstimate> units_by_tags(const MapGraph& map, std::span<const Tag> tags);
// The unit on which two tags or more agree, and more than half of all.
std::optional<UnitEstimate> common_unit(const std::map<TagId, UnitEstimate>& units);

struct TagMapping {
  std::vector<MappedTag> tags;          // by id
  std::vector<MotionWarning> warnings;  // one for each tag left out for a fault
};

// Poses of the tags with a size in `tags` that keyframes of a metric map show. Leaves out tags with few views, whose
// size is not verified, and with a warning those whose size in the map is another one, and those at two places.
TagMapping map_tags(const MapGraph& map, std::span<const Tag> tags);

// Writes the tags to notes of a map, each under the key "tag FAMILY NUMBER": readable numbers with names.
void write_tags(std::span<const MappedTag> tags, std::map<std::string, std::string>& notes);
// Reads the notes of write_tags, by id; ignores notes in another format.
std::vector<MappedTag> stored_tags(const std::map<std::string, std::string>& notes);

// Tags of a map that is moved and scaled.
std::vector<MappedTag> moved(std::vector<MappedTag> tags, const Similarity& target_from_map);

// Adds the tags that are surveyed with a heading on the plan of a map, and that it does not have. Precondition: the map
// is registered on a plan, by the height of the body above the floor.
void add_surveyed_tags(StoredMap& stored, std::span<const Tag> tags);

}  // namespace byre
