#include "byre/cli/shared/method_arguments.h"

#include "byre/base/printable.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/playback/options_file.h"
#include "byre/slam/system/option_table.h"

#include <algorithm>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

// Checks and keeps a setting.
void add_setting(const std::string& flag, const std::string& name, const std::string& text,
                 MethodArguments& arguments) {
  MethodOptions scratch;
  if (const auto fault = set_option(scratch, name, text)) {
    throw CLI::ValidationError(flag, printable(fault->reason) + "; " + fault->remedy);
  }
  arguments.settings.emplace_back(name, text);
}

}  // namespace

MethodOptions MethodArguments::options() const {
  MethodOptions options;
  if (file) read_options(*file, options);
  if (is_live) options.pace = Pace::live;
  for (const auto& [name, text] : settings) set_option(options, name, text);
  return options;
}

void declare_method_option(CLI::App& command, const std::string& flag, const std::string& name,
                           MethodArguments& arguments, const std::string& help) {
  const auto option = std::ranges::find(option_table(), name, &MethodOption::name);
  if (option == option_table().end()) throw std::logic_error("no option " + name);
  const bool is_choice = option->range.find('|') != std::string::npos;
  const auto keep = [flag, name, &arguments](const std::string& text) { add_setting(flag, name, text, arguments); };
  command.add_option_function<std::string>(flag, keep, fmt::format("{} ({})", help, option->get({})))
      ->type_name(is_choice ? option->range : "NUMBER");
}

CLI::Option* declare_method_flag(CLI::App& command, const std::string& flag, const std::string& name,
                                 const std::string& value, MethodArguments& arguments, const std::string& help) {
  return command.add_flag_callback(
      flag, [=, &arguments] { add_setting(flag, name, value, arguments); }, help);
}

void declare_options_file(CLI::App& command, MethodArguments& arguments) {
  add_input(command, Input::file, "--options", arguments.file,
            "Options of the method as printed by --print-options; command line options win over the file")
      ->type_name("YAML");
  const auto keep = [&arguments](const std::vector<std::string>& settings) {
    for (const std::string& setting : settings) {
      const std::size_t equals = setting.find('=');
      if (equals == std::string::npos) {
        throw CLI::ValidationError("--set", "'" + printable(setting) + "' has no value; give NAME=VALUE");
      }
      add_setting("--set", setting.substr(0, equals), setting.substr(equals + 1), arguments);
    }
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--set", keep, "One option of the method, such as tracking.min_inliers=20; --print-options lists all")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
  const auto print = [&arguments] {
    std::cout << options_file(arguments.options()) << std::flush;
    if (!std::cout) throw std::runtime_error("the options cannot be written to the standard output");
    throw CLI::Success();
  };
  command.add_flag_callback("--print-options", print, "Print the resulting values of all options as YAML, and exit");
}

}  // namespace byre::cli
