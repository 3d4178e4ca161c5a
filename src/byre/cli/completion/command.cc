#include "byre/cli/commands.h"
#include "byre/cli/completion/script.h"
#include "byre/cli/shared/choice.h"

#include <memory>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr const char* kFooter = R"(Examples:
  source <(byre completion bash)
  byre completion bash > ~/.local/share/bash-completion/completions/byre
  byre completion zsh > ~/.zfunc/_byre

The script is generated from the commands, with all options, file types and choices. The installation of byre
includes both scripts. For zsh the folder must be in fpath before compinit is called.)";

}  // namespace

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
