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

}  // namespace byre
