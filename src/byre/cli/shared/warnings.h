#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace byre::cli {

// One per line; of a large number only the first, and the number of the rest.
void show_warnings(std::ostream& stream, const std::vector<std::string>& warnings);

}  // namespace byre::cli
