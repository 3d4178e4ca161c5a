// Completes command lines in the shells for all declarations of commands: new options are covered automatically.

#include "byre/cli/completion/command.h"

#include "byre/cli/commands.h"
#include "byre/cli/shared/program_fixture.h"

#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsSupersetOf;

// Command line with the expected completions of its last word.
struct Expected {
  std::string line;  // a trailing space begins a new word
  std::set<std::string> words;
};

std::vector<CLI::App*> commands_below(CLI::App& command) {
  return command.get_subcommands([](CLI::App*) { return true; });
}

std::set<std::string> names_of(const CLI::Option& option) {
  std::set<std::string> names;
  for (const std::string& name : option.get_snames()) names.insert("-" + name);
  for (const std::string& name : option.get_lnames()) names.insert("--" + name);
  return names;
}

// All commands, options and choices.
void collect(CLI::App& command, const std::string& line, std::vector<Expected>& expected) {
  Expected options{line + "-", {}}, below{line, {}};
  for (const CLI::Option* const option : command.get_options()) {
    const std::set<std::string> names = names_of(*option);
    options.words.insert(names.begin(), names.end());
    const std::vector<std::string> choices = choices_of(*option);
    if (choices.empty()) continue;
    if (names.empty()) expected.push_back({line, {choices.begin(), choices.end()}});
    for (const std::string& name : names) expected.push_back({line + name + " ", {choices.begin(), choices.end()}});
  }
  expected.push_back(options);
  for (CLI::App* const each : commands_below(command)) {
    below.words.insert(each->get_name());
    collect(*each, line + each->get_name() + " ", expected);
  }
  if (!below.words.empty()) expected.push_back(below);
}

class Completion : public ProgramTest {
 protected:
  Completion() { declare_commands(app_, action_); }

  // Completions of bash for each line.
  std::vector<std::set<std::string>> in_bash(const std::vector<std::string>& lines) const {
    std::string script =
        "source completion\ncomplete_line() {\n  COMP_WORDS=(\"$@\")\n  COMP_CWORD=$(($# - 1))\n  _byre\n";
    script += "  printf '%s|' \"${COMPREPLY[@]}\"\n  echo\n}\n";
    for (const std::string& line : lines) script += "complete_line " + line + (line.back() == ' ' ? "''\n" : "\n");
    write("completion", run("completion bash").output);
    write("script", script);
    EXPECT_EQ(std::system(("cd '" + folder_.string() + "' && bash --norc script >said 2>&1").c_str()), 0)
        << read("said");
    std::vector<std::set<std::string>> offered;
    std::istringstream said(read("said"));
    for (std::string line; std::getline(said, line);) {
      std::istringstream words(line);
      offered.emplace_back();
      for (std::string word; std::getline(words, word, '|');) {
        if (!word.empty()) offered.back().insert(word);
      }
    }
    EXPECT_EQ(offered.size(), lines.size()) << read("said");
    offered.resize(lines.size());
    return offered;
  }

  // Line after completion by zsh.
  std::string in_zsh(const std::string& line) const {
    std::filesystem::create_directories(folder_ / "functions");
    write("functions/_byre", run("completion zsh").output);
    write("script",
          "zmodload zsh/zpty\n"
          "zpty shell zsh -f -i\n"
          "zpty -w shell 'PS1=; fpath=($PWD/functions $fpath); autoload -Uz compinit; compinit -u -D; unsetopt beep'\n"
          "zpty -w shell 'finish() { print -r -- \"\\n[[$BUFFER]]\"; exit }; zle -N finish; bindkey ^X finish'\n"
          "zpty -w shell 'zstyle \":completion:*\" list-prompt \"\"; setopt no_auto_list; print ready'\n"
          "zpty -r shell said '*ready*ready*'\n"
          "zpty -n -w shell $'" +
              line +
              "\\t\\C-X'\n"
              "zpty -r shell said '*]]*'\n"
              "print -r -- \"$said\"\n");
    EXPECT_EQ(std::system(("cd '" + folder_.string() + "' && timeout 30 zsh -f script >said 2>&1").c_str()), 0);
    const std::string said = read("said");
    const std::size_t begin = said.rfind("[["), end = said.rfind("]]");
    return begin == std::string::npos || end == std::string::npos ? said : said.substr(begin + 2, end - begin - 2);
  }

  static bool has_zsh() { return std::system("command -v zsh >/dev/null") == 0; }

  CLI::App app_{"test", "byre"};
  Action action_;
};

TEST_F(Completion, ContainsAllCommandsOptionsAndChoicesInBash) {
  std::vector<Expected> expected;
  collect(app_, "byre ", expected);
  std::vector<std::string> lines;
  for (const Expected& each : expected) lines.push_back(each.line);
  const auto offered = in_bash(lines);
  EXPECT_GT(lines.size(), 30U);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_THAT(offered[i], IsSupersetOf(expected[i].words)) << lines[i];
  }
}

TEST_F(Completion, OffersFilesAndFolders) {
  write("barn 1.byre", "");
  std::filesystem::create_directories(folder_ / "barn_2");
  const auto offered =
      in_bash({"byre map -o bar", "byre map --output = bar", "byre inspect bar", "byre export-colmap x -o bar",
               "byre map barn_2 --start ", "byre --no-overwrite map --pace = in", "byre evaluate --al"});
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(offered[static_cast<std::size_t>(i)], testing::UnorderedElementsAre("barn 1.byre", "barn_2")) << i;
  }
  EXPECT_THAT(offered[3], ElementsAre("barn_2")) << "a model is a folder";
  EXPECT_THAT(offered[4], IsEmpty()) << "seconds are not a file";
  EXPECT_THAT(offered[5], ElementsAre("inline"));
  EXPECT_THAT(offered[6], ElementsAre("--align", "--aligned", "--alignment"));
}

TEST_F(Completion, OffersChoices) {
  std::vector<CLI::App*> commands = {&app_};
  int choices = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    for (CLI::App* const below : commands_below(*commands[i])) commands.push_back(below);
    for (CLI::Option* const option : commands[i]->get_options()) {
      for (const std::string& choice : choices_of(*option)) {
        option->clear();
        option->add_result(choice);
        EXPECT_NO_THROW(option->run_callback())
            << commands[i]->get_name() << " " << option->get_name() << " " << choice;
        ++choices;
      }
    }
  }
  EXPECT_GT(choices, 30);
}

TEST_F(Completion, CompletesInZsh) {
  if (!has_zsh()) GTEST_SKIP() << "no zsh here";
  std::filesystem::create_directories(folder_ / "barn_2");
  write("barn_2/image.png", "");
  for (const auto& [line, completed] :
       std::vector<std::pair<std::string, std::string>>{{"byre valid", "byre validate "},
                                                        {"byre map --caus", "byre map --causal-trajectory="},
                                                        {"byre map --pace inl", "byre map --pace inline "},
                                                        {"byre map --pace=inl", "byre map --pace=inline "},
                                                        {"byre vocabulary tra", "byre vocabulary train "},
                                                        {"byre map bar", "byre map barn_2/"},
                                                        {"byre completion z", "byre completion zsh "}}) {
    EXPECT_EQ(in_zsh(line), completed);
  }
}

TEST_F(Completion, RejectsUnknownShells) {
  EXPECT_EQ(run("completion fish").exit_code, 2);
  EXPECT_EQ(run("completion").exit_code, 2);
  EXPECT_THAT(run("completion zsh").output, testing::StartsWith("#compdef byre\n"));
}

}  // namespace
}  // namespace byre::cli
