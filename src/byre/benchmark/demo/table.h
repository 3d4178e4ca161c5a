#pragma once

#include "byre/benchmark/demo/findings.h"

#include <string>
#include <vector>

namespace byre {

struct DemoCell {
  std::string text;  // a dash if not applicable
  bool is_best = false;
};

struct DemoRow {
  std::string measure;  // with unit
  std::vector<DemoCell> cells;
};

// A comparison with one cell per arm, in their order.
std::vector<DemoRow> demo_table(const std::vector<DemoArm>& arms);

// "Hybrid", as on the page.
std::string shown_name(Arm arm);

std::string to_text(const std::vector<DemoRow>& rows, const std::vector<DemoArm>& arms);

}  // namespace byre
