#pragma once

#include "byre/playback/archive/map_inspection.h"
#include "byre/playback/report/report.h"

#include <string>
#include <vector>

namespace byre {

struct InspectedFile {
  std::string name;
  std::size_t bytes = 0;
  std::vector<SectionSize> sections;
};

Report inspection_report(const StoredMap& stored, const MapInspection& inspection, const InspectedFile& file);

// Conclusion of the inspection alone: whether the map is ready for missions, and the next command.
std::string next_step_with(const StoredMap& stored, const std::string& file_name);

}  // namespace byre
