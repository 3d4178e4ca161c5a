#pragma once

#include "byre/demo/findings.h"

#include <string>
#include <vector>

namespace byre {

// What one row of the comparison says of an arm.
struct DemoCell {
  std::string text;  // a dash where it does not apply
  bool is_best = false;
};

struct DemoRow {
  std::string measure;  // with the unit
  std::vector<DemoCell> cells;
};

// The arms side by side, a cell for each in their order.
std::vector<DemoRow> demo_table(const std::vector<DemoArm>& arms);

// "Hybrid", as a page calls it.
std::string shown_name(Arm arm);

// The table for a terminal.
std::string to_text(const std::vector<DemoRow>& rows, const std::vector<DemoArm>& arms);

}  // namespace byre
