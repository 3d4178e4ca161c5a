#include "byre/cli/shared/file_arguments.h"

#include "byre/base/regular_file.h"
#include "byre/calibration_file.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoOverwrite = "--no-overwrite";

// An option stores its declaration as the name of a validator, which the help does not show.
constexpr const char* kText = "text";
constexpr std::array kInputs = {
    std::pair(Input::file, "reads file"),     std::pair(Input::recording, "reads recording"),
    std::pair(Input::plan, "reads plan"),     std::pair(Input::colmap_model, "reads model"),
    std::pair(Input::images, "reads images"), std::pair(Input::folder, "reads folder")};
constexpr std::array kOutputs = {std::pair(Output::map, "writes map"),
                                 std::pair(Output::refined_map, "writes refined map"),
                                 std::pair(Output::updated_map, "writes updated map"),
                                 std::pair(Output::viewed_map, "writes viewed map"),
                                 std::pair(Output::trajectory, "writes trajectory"),
                                 std::pair(Output::json, "writes JSON"),
                                 std::pair(Output::picture, "writes picture"),
                                 std::pair(Output::grid, "writes grid"),
                                 std::pair(Output::video, "writes video"),
                                 std::pair(Output::point_cloud, "writes point cloud"),
                                 std::pair(Output::mcap, "writes MCAP"),
                                 std::pair(Output::calibration, "writes calibration"),
                                 std::pair(Output::vocabulary, "writes vocabulary"),
                                 std::pair(Output::colmap_model, "writes model"),
                                 std::pair(Output::recording, "writes recording"),
                                 std::pair(Output::folder, "writes folder")};

template <typename Kind, std::size_t n>
const char* name_of(const std::array<std::pair<Kind, const char*>, n>& names, Kind kind) {
  return std::ranges::find(names, kind, &std::pair<Kind, const char*>::first)->second;
}

template <typename Kind, std::size_t n>
std::optional<Kind> kind_named(const std::array<std::pair<Kind, const char*>, n>& names, const std::string& name) {
  for (const auto& [kind, each] : names) {
    if (name == each) return kind;
  }
  return std::nullopt;
}

// Name of the validator that declares the option; empty without one. Iterates by index, because a search by name throws
// for each absent name, and commands have hundreds of options.
std::string declaration_of(CLI::Option& option) {
  try {
    for (int i = 0;; ++i) {
      const std::string& name = option.get_validator(i)->get_name();
      if (name == kText || kind_named(kInputs, name) || kind_named(kOutputs, name)) return name;
    }
  } catch (const CLI::OptionNotFound&) {
    return "";
  }
}

CLI::Option* declare_file(CLI::Option* option, const char* name) {
  const auto require_name = [](const std::string& path) {
    return path.empty() ? std::string("is empty: give a file or folder (is a shell variable not set?)") : std::string();
  };
  return option->check(CLI::Validator(require_name, "", name));
}

// Given commands, outermost first.
std::vector<CLI::App*> given_commands(CLI::App& command) {
  std::vector<CLI::App*> commands = {&command};
  for (CLI::App* const below : command.get_subcommands()) {
    for (CLI::App* const each : given_commands(*below)) commands.push_back(each);
  }
  return commands;
}

Output kind_of(Output output, const fs::path& path) {
  if (output != Output::recording) return output;
  return path.extension() == ".mcap" ? Output::mcap : Output::folder;
}

NamedFiles arguments_of(CLI::App& command) {
  NamedFiles arguments;
  for (CLI::App* const given : given_commands(command)) {
    for (CLI::Option* const option : given->get_options()) {
      if (option->results().empty()) continue;
      const auto input = input_of(*option);
      const auto output = output_of(*option);
      for (const std::string& path : option->results()) {
        if (input) arguments.inputs.push_back({*input, option->get_name(), file_of_camera(path)});
        if (output) arguments.outputs.push_back({kind_of(*output, path), option->get_name(), path});
      }
    }
  }
  return arguments;
}

bool has_no_overwrite(const CLI::App& command) {
  const CLI::Option* const option = command.get_option_no_throw(kNoOverwrite);
  return option != nullptr && option->count() > 0;
}

// --no-overwrite may be anywhere on the command line.
bool wants_no_overwrite(CLI::App& command) {
  for (const CLI::App* each = command.get_parent(); each != nullptr; each = each->get_parent()) {
    if (has_no_overwrite(*each)) return true;
  }
  return std::ranges::any_of(given_commands(command), [](const CLI::App* given) { return has_no_overwrite(*given); });
}

// Without a named output, a refined map replaces its input.
void require_absent_map(CLI::App& command, const NamedFiles& arguments) {
  for (CLI::Option* const option : command.get_options()) {
    if (output_of(*option) != Output::refined_map || option->count() > 0) continue;
    for (const NamedInput& read : arguments.inputs) {
      if (read.argument == "MAP") require_absent(read.argument, read.path);
    }
  }
}

void require_nothing_replaced(CLI::App& command, const NamedFiles& arguments) {
  require_absent(arguments.outputs);
  for (CLI::App* const given : given_commands(command)) require_absent_map(*given, arguments);
}

}  // namespace

CLI::Option* declare(CLI::Option* option, Input input) {
  return declare_file(option, name_of(kInputs, input));
}

CLI::Option* declare(CLI::Option* option, Output output) {
  return declare_file(option, name_of(kOutputs, output));
}

CLI::Option* declare_text(CLI::Option* option) {
  return option->check(CLI::Validator([](const std::string&) { return std::string(); }, "", kText));
}

std::optional<Input> input_of(CLI::Option& option) {
  return kind_named(kInputs, declaration_of(option));
}

std::optional<Output> output_of(CLI::Option& option) {
  return kind_named(kOutputs, declaration_of(option));
}

bool is_text(CLI::Option& option) {
  return declaration_of(option) == kText;
}

void declare_no_overwrite(CLI::App& command) {
  command.add_flag(kNoOverwrite)->description("Do not replace existing files");
}

void require_safe_files(CLI::App& command) {
  const NamedFiles arguments = arguments_of(command);
  try {
    require_not_read(arguments);
    require_distinct(arguments.outputs);
    if (wants_no_overwrite(command)) require_nothing_replaced(command, arguments);
    require_same_kinds(arguments.outputs);
  } catch (const FileConflict& conflict) {
    throw CLI::ValidationError(conflict.argument(), conflict.what());
  }
}

void require_files_or_folders(CLI::App& command) {
  for (const NamedInput& read : arguments_of(command).inputs) refuse_pipe(read.path);
}

void check_when_parsed(CLI::App& command, std::function<void()> check) {
  command.parse_complete_callback([&command, check = std::move(check)] {
    require_safe_files(command);
    if (check) check();
  });
}

}  // namespace byre::cli
