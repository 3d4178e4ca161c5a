#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace byre::cli {

// One a line; of very many only the first, and how many more there are.
void show_warnings(std::ostream& stream, const std::vector<std::string>& warnings);

}  // namespace byre::cli
