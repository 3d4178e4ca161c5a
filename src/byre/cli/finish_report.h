#pragma once

#include "byre/slam/finishing.h"

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace byre::cli {

// What finishing a map changed, and how sound it is now.
struct Finishing {
  FinishReport report;
  bool cut_short = false;           // by Ctrl-C
  double seconds = 0.0;             // wall time
  std::vector<std::string> faults;  // of the map as it is kept
};

// Rows for people, each a name and what is known under it.
std::string to_text(const Finishing& finishing);
nlohmann::ordered_json to_json(const Finishing& finishing);

}  // namespace byre::cli
