#include "byre/cli/completion/command.h"

#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string_view>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

enum class Completed : std::uint8_t { nothing, choices, files, folders };

// Command with its path, without the program's name: "vocabulary train".
struct NamedCommand {
  std::string names;
  CLI::App* command = nullptr;
};

std::vector<CLI::App*> commands_below(CLI::App& command) {
  return command.get_subcommands([](CLI::App*) { return true; });
}

std::vector<NamedCommand> commands_from(CLI::App& command, const std::string& names = {}) {
  std::vector<NamedCommand> found = {{names, &command}};
  for (CLI::App* const below : commands_below(command)) {
    const std::string longer = names.empty() ? below->get_name() : names + " " + below->get_name();
    for (const NamedCommand& each : commands_from(*below, longer)) found.push_back(each);
  }
  return found;
}

bool takes_a_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

bool takes_many(const CLI::Option& option) {
  return option.get_expected_max() > 1;
}

Completed completed(CLI::Option& option) {
  if (!choices_of(option).empty()) return Completed::choices;
  const auto input = input_of(option);
  const auto output = output_of(option);
  if (input == Input::folder || input == Input::colmap_model) return Completed::folders;
  if (output == Output::folder || output == Output::colmap_model) return Completed::folders;
  return input || output ? Completed::files : Completed::nothing;
}

std::vector<std::string> option_names(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : std::string(between)) + word;
  return text;
}

// Single quotes for both shells.
std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char letter : text) {
    if (letter == '\'') {
      result += "'\\''";
    } else {
      result += letter;
    }
  }
  return result + "'";
}

// ---- bash

constexpr const char* kBashHead = R"(# Completion of byre for bash, made by "byre completion bash".

_byre_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }

_byre_files() {
  compopt -o filenames -o default 2>/dev/null
  mapfile -t COMPREPLY < <(compgen "$1" -- "$word")
}

_byre() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command= i
  COMPREPLY=()
  if [[ $word == = ]]; then
    word=
  elif [[ $previous == = ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${COMP_WORDS[i]}" in
)";

std::string bash_action(CLI::Option& option) {
  switch (completed(option)) {
    case Completed::choices:
      return "_byre_words " + in_quotes(joined(choices_of(option), " "));
    case Completed::files:
      return "_byre_files -f";
    case Completed::folders:
      return "_byre_files -d";
    case Completed::nothing:
      break;
  }
  return ":";
}

// Completions after an option.
std::string bash_values(const NamedCommand& named) {
  std::string text;
  for (CLI::Option* const option : named.command->get_options()) {
    if (!option->nonpositional() || !takes_a_value(*option)) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : option_names(*option)) patterns.push_back(in_quotes(named.names + " " + name));
    text += "    " + joined(patterns, " | ") + ") " + bash_action(*option) + "; return ;;\n";
  }
  return text;
}

// Completions elsewhere: options, else subcommands or the first argument.
std::string bash_words(const NamedCommand& named) {
  std::vector<std::string> options;
  std::string otherwise = ":";
  for (CLI::Option* const option : named.command->get_options()) {
    if (option->nonpositional()) {
      for (const std::string& name : option_names(*option)) options.push_back(name);
    } else if (otherwise == ":") {
      otherwise = bash_action(*option);
    }
  }
  std::vector<std::string> below;
  for (const CLI::App* const command : commands_below(*named.command)) below.push_back(command->get_name());
  if (!below.empty()) otherwise = "_byre_words " + in_quotes(joined(below, " "));
  return "    " + in_quotes(named.names) + ") if [[ $word == -* ]]; then _byre_words " +
         in_quotes(joined(options, " ")) + "; else " + otherwise + "; fi ;;\n";
}

// ---- zsh

std::string zsh_function(const NamedCommand& named) {
  std::string name = named.names.empty() ? "_byre" : "_byre_" + named.names;
  std::ranges::replace(name, ' ', '_');
  return name;
}

std::string escaped(std::string_view text, std::string_view letters) {
  std::string result;
  for (const char letter : text) {
    if (letter == '\\' || letters.find(letter) != std::string_view::npos) result += '\\';
    result += letter;
  }
  return result;
}

// ":MESSAGE:ACTION" for _arguments.
std::string zsh_action(CLI::Option& option) {
  const std::string message = option.nonpositional() ? option.get_type_name() : option.get_name();
  std::string action = " ";
  if (completed(option) == Completed::choices) action = "(" + joined(choices_of(option), " ") + ")";
  if (completed(option) == Completed::files) action = "_files";
  if (completed(option) == Completed::folders) action = "_files -/";
  return ":" + escaped(message, ":") + ":" + action;
}

std::string zsh_argument(CLI::Option& option) {
  if (!option.nonpositional()) return in_quotes((takes_many(option) ? "*" : "") + zsh_action(option));
  std::vector<std::string> names = option_names(option);
  std::string text = takes_many(option) ? "'*'" : in_quotes("(" + joined(names, " ") + ")");
  const bool has_value = takes_a_value(option);
  for (std::string& name : names) name += has_value && name.starts_with("--") ? "=" : "";
  text += names.size() == 1 ? names.front() : "{" + joined(names, ",") + "}";
  const std::string explained = "[" + escaped(option.get_description(), "[]") + "]";
  return text + in_quotes(explained + (has_value ? zsh_action(option) : ""));
}

// Subcommands, then the arguments of the one given.
std::string zsh_state(const NamedCommand& named) {
  std::string commands, calls;
  for (CLI::App* const below : commands_below(*named.command)) {
    const std::string name = below->get_name();
    const std::string names = named.names.empty() ? name : named.names + " " + name;
    commands += "    " + in_quotes(name + ":" + below->get_description()) + "\n";
    calls += "        " + name + ") " + zsh_function({names, below}) + " ;;\n";
  }
  return "  local -a commands=(\n" + commands + "  )\n  case $state in\n" +
         "    command) _describe command commands ;;\n    arguments)\n      case $words[1] in\n" + calls +
         "      esac ;;\n  esac\n";
}

std::string zsh_body(const NamedCommand& named) {
  const bool is_leaf = commands_below(*named.command).empty();
  std::string text = zsh_function(named) + "() {\n";
  if (!is_leaf) text += "  local curcontext=$curcontext context state state_descr line\n  typeset -A opt_args\n";
  text += is_leaf ? "  _arguments -s" : "  _arguments -C -s";
  for (CLI::Option* const option : named.command->get_options()) text += " \\\n    " + zsh_argument(*option);
  if (!is_leaf) text += " \\\n    '1:command:->command' \\\n    '*::argument:->arguments'";
  return text + "\n" + (is_leaf ? "" : zsh_state(named)) + "}\n\n";
}

constexpr const char* kFooter = R"(Examples:
  source <(byre completion bash)
  byre completion bash > ~/.local/share/bash-completion/completions/byre
  byre completion zsh > ~/.zfunc/_byre

The script is generated from the commands, with all options, file types and choices. The installation of byre
includes both scripts. For zsh the folder must be in fpath before compinit is called.)";

}  // namespace

std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const bool is_list = type.find('|') != std::string::npos;
  const auto is_upper = [](char letter) { return letter >= 'A' && letter <= 'Z'; };
  if (!is_list || std::ranges::any_of(type, is_upper)) return {};
  return CLI::detail::split(type, '|');
}

std::string bash_completion(CLI::App& program) {
  std::vector<std::string> paths;
  std::string values, words;
  for (const NamedCommand& named : commands_from(program)) {
    const bool is_below_another = named.names.find(' ') != std::string::npos;
    if (!named.names.empty()) paths.push_back(in_quotes(is_below_another ? named.names : " " + named.names));
    values += bash_values(named);
    words += bash_words(named);
  }
  return kBashHead + ("      " + joined(paths, " | ")) +
         ") command+=${command:+ }${COMP_WORDS[i]} ;;\n    esac\n  done\n  case \"$command $previous\" in\n" + values +
         "  esac\n  case \"$command\" in\n" + words + "  esac\n}\n\ncomplete -F _byre byre\n";
}

std::string zsh_completion(CLI::App& program) {
  std::string text = "#compdef byre\n# Completion of byre for zsh, made by \"byre completion zsh\".\n\n";
  for (const NamedCommand& named : commands_from(program)) text += zsh_body(named);
  return text + "if [[ $funcstack[1] == _byre ]]; then\n  _byre \"$@\"\nelse\n  compdef _byre byre\nfi\n";
}

Action declare_completion(CLI::App& command) {
  const auto shell = std::make_shared<std::string>();
  command.add_option("SHELL", *shell, "Shell that completes byre's commands")
      ->type_name("bash|zsh")
      ->required()
      ->transform(one_of<std::string>({{"bash", "bash"}, {"zsh", "zsh"}}));
  command.footer(kFooter);
  return [&command, shell](std::ostream& result) {
    CLI::App& program = *command.get_parent();
    result << (*shell == "bash" ? bash_completion(program) : zsh_completion(program));
    return done;
  };
}

}  // namespace byre::cli
