#pragma once

#include "byre/playback/archive/map_inspection.h"

#include <string>
#include <vector>

namespace byre {

struct InspectedFile {
  std::string name;
  std::size_t bytes = 0;
  std::vector<SectionSize> sections;
};

std::string to_text(const StoredMap& stored, const MapInspection& inspection, const InspectedFile& file);
std::string to_json(const StoredMap& stored, const MapInspection& inspection, const InspectedFile& file);

}  // namespace byre
