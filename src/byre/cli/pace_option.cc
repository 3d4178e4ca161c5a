#include "byre/cli/pace_option.h"

#include <map>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {

void declare_pace(CLI::App& command, Pace& pace) {
  std::map<std::string, Pace> paces;
  for (const Pace known : {Pace::same_thread, Pace::paced, Pace::live}) paces.emplace(name_of(known), known);
  command.add_option("--pace", pace, "Where mapping runs and how fast frames are fed (paced)")
      ->type_name("inline|paced|live")
      ->transform(CLI::CheckedTransformer(paces).description(""));
}

}  // namespace byre::cli
