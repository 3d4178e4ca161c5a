#pragma once

#include "byre/slam/system/method_options.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace byre::cli {

// Options of the method on the command line. Settings win over the file; later ones win over earlier ones.
struct MethodArguments {
  std::optional<std::filesystem::path> file;                  // value of --options
  bool is_live = false;                                       // whether live cameras set the pace
  std::vector<std::pair<std::string, std::string>> settings;  // name in the option table, value

  // Throws InputError for faults of the file.
  MethodOptions options() const;
};

// Option of the option table under a name of its own: values, range and default come from the table. The arguments must
// outlive the parsing of the command line.
void declare_method_option(CLI::App& command, const std::string& flag, const std::string& name,
                           MethodArguments& arguments, const std::string& help);
// Flag that sets an option of the table to a value.
CLI::Option* declare_method_flag(CLI::App& command, const std::string& flag, const std::string& name,
                                 const std::string& value, MethodArguments& arguments, const std::string& help);

// --options, --set and --print-options, which prints the resulting options and ends the program. Declare them after the
// options above.
void declare_options_file(CLI::App& command, MethodArguments& arguments);

}  // namespace byre::cli
