#include "byre/cli/shared/arguments.h"

#include "byre/base/nearest_name.h"
#include "byre/base/regular_file.h"
#include "byre/base/text_file.h"
#include "byre/calibration_file.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/core.h>

namespace byre::cli {
namespace {

std::string message(const char* kind, const std::string& unknown, const std::vector<std::string>& names) {
  const auto nearest = nearest_name(unknown, names);
  return std::string("unknown ") + kind + " '" + unknown + "'" + (nearest ? " (did you mean '" + *nearest + "'?)" : "");
}

std::vector<std::string> command_names(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* const command : commands) {
    names.push_back(command->get_name());
    names.insert(names.end(), command->get_aliases().begin(), command->get_aliases().end());
  }
  return names;
}

std::vector<std::string> long_options_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

namespace fs = std::filesystem;

constexpr const char* kNoOverwrite = "--no-overwrite";

// An option stores its declaration as the name of a validator, which the help does not show. It shows the type.
template <typename Kind>
struct Declaration {
  Kind kind;
  const char* name;
  const char* type = "FILE";
};
// Clang 16 deduces no arguments of aggregates.
template <typename Kind, typename... Names>
Declaration(Kind, Names...) -> Declaration<Kind>;

constexpr const char* kText = "text";
constexpr std::array kInputs = {
    Declaration{Input::file, "reads file"},     Declaration{Input::recording, "reads recording"},
    Declaration{Input::plan, "reads plan"},     Declaration{Input::colmap_model, "reads model", "MODEL_DIR"},
    Declaration{Input::images, "reads images"}, Declaration{Input::folder, "reads folder", "FOLDER"}};
constexpr std::array kOutputs = {Declaration{Output::map, "writes map", "MAP"},
                                 Declaration{Output::refined_map, "writes refined map", "MAP"},
                                 Declaration{Output::updated_map, "writes updated map", "MAP"},
                                 Declaration{Output::viewed_map, "writes viewed map", "MAP"},
                                 Declaration{Output::trajectory, "writes trajectory"},
                                 Declaration{Output::json, "writes JSON"},
                                 Declaration{Output::picture, "writes picture"},
                                 Declaration{Output::grid, "writes grid"},
                                 Declaration{Output::video, "writes video"},
                                 Declaration{Output::point_cloud, "writes point cloud"},
                                 Declaration{Output::mcap, "writes MCAP"},
                                 Declaration{Output::calibration, "writes calibration"},
                                 Declaration{Output::vocabulary, "writes vocabulary"},
                                 Declaration{Output::colmap_model, "writes model", "MODEL_DIR"},
                                 Declaration{Output::recording, "writes recording"},
                                 Declaration{Output::folder, "writes folder", "FOLDER"}};

template <typename Kind, std::size_t n>
std::optional<Kind> kind_named(const std::array<Declaration<Kind>, n>& kinds, const std::string& name) {
  const auto found = std::ranges::find(kinds, name, &Declaration<Kind>::name);
  return found == kinds.end() ? std::nullopt : std::optional(found->kind);
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

// The help of an argument without a name of its own shows the type.
template <typename Kind, std::size_t n>
CLI::Option* declare_file(CLI::Option* option, const std::array<Declaration<Kind>, n>& kinds, Kind kind) {
  const auto require_name = [](const std::string& path) {
    return path.empty() ? std::string("is empty: give a file or folder (is a shell variable not set?)") : std::string();
  };
  const Declaration<Kind>& declaration = *std::ranges::find(kinds, kind, &Declaration<Kind>::kind);
  option->type_name(option->get_positional() ? option->get_name() : declaration.type);
  return option->check(CLI::Validator(require_name, "", declaration.name));
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

CLI::Validator number_that(std::function<bool(double)> fits, std::string what) {
  const auto fault_of = [fits = std::move(fits), what = std::move(what)](const std::string& text) {
    const std::optional<double> number = parse_number(text);
    return number && fits(*number) ? std::string() : "\"" + text + "\" is not a number " + what;
  };
  return {fault_of, ""};
}

}  // namespace

std::string unknown_argument(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  const auto subcommands = command->get_subcommands([](const CLI::App*) { return true; });
  const std::vector<std::string> unparsed = command->remaining();
  for (const std::string& argument : arguments) {
    if (std::ranges::find(unparsed, argument) == unparsed.end()) continue;
    if (argument.starts_with("-")) {
      return message("option", argument.substr(0, argument.find('=')), long_options_of(*command));
    }
    if (!subcommands.empty()) return message("command", argument, command_names(subcommands));
  }
  return "";
}

CLI::Option* declare(CLI::Option* option, Input input) {
  return declare_file(option, kInputs, input);
}

CLI::Option* declare(CLI::Option* option, Output output) {
  return declare_file(option, kOutputs, output);
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

CLI::Validator between(double low, double high) {
  return number_that([=](double number) { return low <= number && number <= high; },
                     fmt::format("from {:.12g} to {:.12g}", low, high));
}

CLI::Validator from(double low) {
  return number_that([=](double number) { return low <= number; }, fmt::format("of at least {:.12g}", low));
}

CLI::Validator above_zero() {
  return number_that([](double number) { return number > 0.0; }, "above 0");
}

}  // namespace byre::cli
