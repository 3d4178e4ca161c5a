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

The script is made from the commands themselves, so it knows all options, the files they take and what there is to
choose from. An installed byre brings both scripts along. For zsh the folder must be named in fpath before compinit is
called.)";

}  // namespace

Action declare_completion(CLI::App& command) {
  const auto shell = std::make_shared<std::string>();
  command.add_option("SHELL", *shell, "Which shell is to complete byre's commands")
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
