#include "byre/cli/shared/warnings.h"

#include "byre/base/printable.h"

#include <algorithm>
#include <ostream>

namespace byre::cli {

void show_warnings(std::ostream& stream, const std::vector<std::string>& warnings) {
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(warnings.size(), kShown); ++i) {
    stream << "byre: warning: " << printable(warnings[i]) << "\n";
  }
  if (warnings.size() > kShown) stream << "byre: warning: " << warnings.size() - kShown << " more of this kind\n";
}

}  // namespace byre::cli
