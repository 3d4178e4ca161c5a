// Properties of all commands, generated from their declarations: new options are covered automatically.

#include "byre/cli/shared/arguments.h"

#include "byre/cli/commands.h"
#include "byre/cli/shared/program_fixture.h"
#include "byre/input_error.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <set>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <sys/stat.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// Parser of command lines, given as words.
class CommandLine {
 public:
  CommandLine() { declare_commands(app_, action_); }

  // All commands without subcommands, outermost name first.
  std::vector<std::vector<std::string>> commands() {
    std::vector<std::vector<std::string>> found;
    collect(app_, {}, found);
    return found;
  }

  CLI::App& command(const std::vector<std::string>& names) {
    CLI::App* command = &app_;
    for (const std::string& name : names) command = command->get_subcommand(name);
    return *command;
  }

  // Fault of a command line; empty if valid.
  std::string fault_of(std::vector<std::string> words) {
    std::ranges::reverse(words);
    try {
      app_.parse(std::move(words));
      return "";
    } catch (const CLI::ParseError& error) {
      return error.what();
    }
  }

 private:
  void collect(CLI::App& command, const std::vector<std::string>& names, std::vector<std::vector<std::string>>& found) {
    const std::vector<CLI::App*> below = command.get_subcommands([](CLI::App*) { return true; });
    if (below.empty()) found.push_back(names);
    for (CLI::App* const each : below) {
      std::vector<std::string> longer = names;
      longer.push_back(each->get_name());
      collect(*each, longer, found);
    }
  }

  CLI::App app_{"test", "byre"};
  Action action_;
};

bool takes_a_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

bool accepts(CLI::Option& option, const std::string& value) {
  option.clear();
  for (int i = 0; i < std::max(1, option.get_items_expected_min()); ++i) option.add_result(value);
  try {
    option.run_callback();
  } catch (const CLI::Error&) {
    option.clear();
    return false;
  }
  option.clear();
  return true;
}

std::string value_for(CLI::Option& option) {
  for (const char* const value : {"1", "300", "0:1", "left", "body", "day"}) {
    if (accepts(option, value)) return value;
  }
  ADD_FAILURE() << option.get_name() << ": give a value that it accepts";
  return "";
}

std::vector<CLI::Option*> options_that(CLI::App& command, const std::function<bool(CLI::Option&)>& hold) {
  std::vector<CLI::Option*> options;
  for (CLI::Option* const option : command.get_options()) {
    if (hold(*option)) options.push_back(option);
  }
  return options;
}

bool is_output(CLI::Option& option) {
  return output_of(option).has_value();
}

bool is_input(CLI::Option& option) {
  return input_of(option).has_value();
}

std::string extension_of(Output output) {
  if (output == Output::picture) return ".png";
  if (output == Output::grid) return ".pgm";
  return output == Output::video ? ".mp4" : "";
}

class FileArguments : public ProgramTest {
 protected:
  struct Given {
    std::string argument;
    std::vector<fs::path> files;  // files read for the argument
  };

  Given given(Input input, const std::string& name) const {
    const fs::path place = folder_ / name;
    switch (input) {
      case Input::file:
        return {place.string(), {put(name)}};
      case Input::recording:
        return {place.string(),
                {put(name + "/mav0/cam0/data.csv"), put(name + "/mav0/cam0/sensor.yaml"),
                 put(name + "/mav0/cam0/data/1.png"), put(name + "/mav0/state_groundtruth_estimate0/data.csv"),
                 put(name + "/calibration.yaml")}};
      case Input::plan: {
        const fs::path plan = put(name + ".yaml", "image: " + name + ".png\n");
        return {plan.string(), {plan, put(name + ".png")}};
      }
      case Input::colmap_model:
        return {place.string(), {put(name + "/cameras.bin"), put(name + "/images.bin"), put(name + "/points3D.bin")}};
      case Input::images:
        return {place.string(), {put(name + "/1.png"), put(name + "/below/2.png")}};
      case Input::folder:
        fs::create_directories(place);
        return {place.string(), {place}};
    }
    return {};
  }

  // Path for an output that is another name of the file.
  std::string alias(const fs::path& file, Output output, const std::string& name) const {
    if (output == Output::folder || output == Output::recording || fs::is_directory(file)) return file.string();
    fs::path link = folder_ / (name + extension_of(output));
    fs::path path = link;
    if (output == Output::colmap_model) link = path / "images.bin";
    fs::create_directories(link.parent_path());
    fs::create_hard_link(file, link);
    return path.string();
  }

  // The command with these options, all required options, and all that they need.
  std::vector<std::string> words(const std::vector<std::string>& names, CLI::App& command,
                                 const std::map<CLI::Option*, std::string>& wanted) const {
    std::map<CLI::Option*, std::string> values = wanted;
    std::vector<CLI::Option*> open = options_that(command, [](CLI::Option& option) { return option.get_required(); });
    for (const auto& [option, value] : wanted) open.push_back(option);
    while (!open.empty()) {
      CLI::Option* const option = open.back();
      open.pop_back();
      for (CLI::Option* const needed : option->get_needs()) open.push_back(needed);
      if (!values.contains(option)) values.emplace(option, some_value(*option));
    }
    std::vector<std::string> result = names;
    std::vector<std::string> positionals = {"--"};
    for (CLI::Option* const option : command.get_options()) {
      if (!values.contains(option)) continue;
      std::vector<std::string>& place = option->get_positional() ? positionals : result;
      if (!option->get_positional()) place.push_back(option->get_name());
      if (!takes_a_value(*option)) continue;
      for (int i = 0; i < std::max(1, option->get_items_expected_min()); ++i) place.push_back(values.at(option));
    }
    if (positionals.size() > 1) result.insert(result.end(), positionals.begin(), positionals.end());
    return result;
  }

  void start_over() const {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

 private:
  fs::path put(const std::string& name, const std::string& content = "what must not be lost") const {
    fs::create_directories((folder_ / name).parent_path());
    write(name, content);
    return folder_ / name;
  }

  std::string some_value(CLI::Option& option) const {
    if (!takes_a_value(option)) return "";
    const std::string name = "other" + option.get_name();
    if (const auto input = input_of(option)) return given(*input, name).argument;
    if (const auto output = output_of(option)) return (folder_ / (name + extension_of(*output))).string();
    return value_for(option);
  }
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += "'" + word + "' ";
  return text;
}

// refine, register and, with permission, view replace their input by design.
bool may_replace(CLI::Option& output, CLI::Option& input) {
  const auto written = output_of(output);
  const bool is_in_place =
      written == Output::refined_map || written == Output::updated_map || written == Output::viewed_map;
  return is_in_place && input.get_name() == "MAP";
}

TEST_F(FileArguments, AreDeclaredByEveryTextOption) {
  CommandLine line;
  for (const std::vector<std::string>& names : line.commands()) {
    for (CLI::Option* const option : options_that(line.command(names), [](auto& o) { return takes_a_value(o); })) {
      if (is_input(*option) || is_output(*option) || is_text(*option)) continue;
      EXPECT_FALSE(accepts(*option, "some/file")) << joined(names) << option->get_name();
    }
  }
}

TEST_F(FileArguments, AreDetectedIfUndeclared) {
  CLI::App app;
  std::string path;
  double number = 0.0;
  EXPECT_TRUE(accepts(*app.add_option("--path", path), "some/file"));
  EXPECT_FALSE(accepts(*app.add_option("--number", number), "some/file"));
}

TEST_F(FileArguments, AreRejectedIfAnOutputIsAnInput) {
  int pairs = 0;
  for (const std::vector<std::string>& names : CommandLine().commands()) {
    CommandLine listed;
    CLI::App& command = listed.command(names);
    for (CLI::Option* const output : options_that(command, is_output)) {
      for (CLI::Option* const input : options_that(command, is_input)) {
        if (may_replace(*output, *input)) continue;
        start_over();
        const Given read = given(*input_of(*input), "read");
        for (std::size_t i = 0; i < read.files.size(); ++i) {
          const std::string written = alias(read.files[i], *output_of(*output), "written" + std::to_string(i));
          const auto line = words(names, command, {{output, written}, {input, read.argument}});
          EXPECT_THAT(CommandLine().fault_of(line), HasSubstr("cannot be overwritten")) << joined(line);
          ++pairs;
        }
      }
    }
  }
  EXPECT_GT(pairs, 200);
  EXPECT_THAT(CommandLine().fault_of({"map", "rec", "--extend", "none.byre", "-o", "./none.byre"}),
              HasSubstr("cannot be overwritten"));  // detected although no such file exists
}

TEST_F(FileArguments, StayUnchangedWhenRejected) {
  for (const std::vector<std::string>& names : CommandLine().commands()) {
    CommandLine listed;
    CLI::App& command = listed.command(names);
    for (CLI::Option* const output : options_that(command, is_output)) {
      for (CLI::Option* const input : options_that(command, is_input)) {
        if (may_replace(*output, *input)) continue;
        start_over();
        const Given read = given(*input_of(*input), "read");
        const std::string written = alias(read.files.front(), *output_of(*output), "written");
        const std::string line = joined(words(names, command, {{output, written}, {input, read.argument}}));
        const auto bytes = [&] {
          return fs::is_directory(read.files.front()) ? ""
                                                      : ProgramTest::read(fs::relative(read.files.front(), folder_));
        };
        const std::string before = bytes();
        const Outcome outcome = run(line);
        EXPECT_EQ(outcome.exit_code, 2) << line << outcome.errors;
        EXPECT_EQ(bytes(), before) << line;
        break;  // one input suffices: the test above tries all
      }
    }
  }
}

TEST_F(FileArguments, AreRejectedIfEmpty) {
  for (const std::vector<std::string>& names : CommandLine().commands()) {
    CommandLine listed;
    CLI::App& command = listed.command(names);
    for (CLI::Option* const option : options_that(command, [](auto& o) { return is_input(o) || is_output(o); })) {
      const auto line = words(names, command, {{option, ""}});
      EXPECT_THAT(CommandLine().fault_of(line), HasSubstr("is empty")) << joined(line);
    }
  }
}

TEST_F(FileArguments, ReplaceOnlyFilesOfTheSameKindOrNone) {
  for (const std::vector<std::string>& names : CommandLine().commands()) {
    CommandLine listed;
    CLI::App& command = listed.command(names);
    for (CLI::Option* const output : options_that(command, is_output)) {
      start_over();
      const bool is_folder = output_of(*output) == Output::folder || output_of(*output) == Output::recording;
      const bool is_in_folder = output_of(*output) == Output::colmap_model || is_folder;
      const std::string path = "there" + extension_of(*output_of(*output));
      const std::string file = is_in_folder ? path + "/cameras.bin" : path;
      if (is_in_folder) fs::create_directories(folder_ / path);
      const auto line = words(names, command, {{output, (folder_ / path).string()}});
      auto keeping = line;
      keeping.insert(keeping.begin(), "--no-overwrite");

      write(file,
            "\x89"
            "BYRE\r\n is how a map begins");
      const bool is_map = output_of(*output) <= Output::viewed_map;  // first in the list of kinds
      if (is_map) write(file, "\x89PNG\r\n is how an image begins");
      EXPECT_THAT(CommandLine().fault_of(keeping), HasSubstr("is not replaced because of --no-overwrite"))
          << joined(line);
      if (is_folder) continue;  // its contents belong to the command
      if (output_of(*output) == Output::colmap_model) continue;
      EXPECT_THAT(CommandLine().fault_of(line), HasSubstr("exists and is not the expected kind of file"))
          << joined(line);
      write(file, "");
      EXPECT_THAT(CommandLine().fault_of(line), testing::Not(HasSubstr("exists and"))) << joined(line);
    }
  }
}

TEST_F(FileArguments, AreRejectedAsTwoEqualOutputs) {
  for (const char* const other : {"out.txt", "./out.txt", "link.txt"}) {
    start_over();
    fs::create_symlink("out.txt", folder_ / "link.txt");
    // Neither file exists, nor does the recording.
    const Outcome outcome = run("map absent -o out.txt --trajectory '" + std::string(other) + "'");
    EXPECT_EQ(outcome.exit_code, 2) << other;
    EXPECT_THAT(outcome.errors, HasSubstr("is given for two outputs")) << other;
  }
}

TEST_F(FileArguments, MayHaveTheNameOfABuiltInProtocol) {
  const std::string folder = (folder_ / "euroc").string();
  EXPECT_THAT(CommandLine().fault_of({"benchmark", folder, "-o", folder}), IsEmpty());
  fs::create_directory(folder);
  EXPECT_THAT(CommandLine().fault_of({"benchmark", folder, "-o", folder}), IsEmpty());
}

TEST_F(FileArguments, KeepAMapRefinedInPlaceWithNoOverwrite) {
  write("barn.byre",
        "\x89"
        "BYRE\r\n");
  const std::string map = (folder_ / "barn.byre").string();
  EXPECT_THAT(CommandLine().fault_of({"refine", map}), IsEmpty());
  EXPECT_THAT(CommandLine().fault_of({"refine", map, "-o", map}), IsEmpty());
  EXPECT_THAT(CommandLine().fault_of({"refine", map, "--no-overwrite"}), HasSubstr("because of --no-overwrite"));
}

TEST_F(FileArguments, AreRejectedIfPipesOrCyclicLinks) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  fs::create_symlink("circle", folder_ / "circle");
  for (const char* const name : {"pipe", "circle"}) {
    const std::string path = (folder_ / name).string();
    for (const std::vector<std::string>& names : CommandLine().commands()) {
      CommandLine listed;
      CLI::App& command = listed.command(names);
      for (CLI::Option* const input : options_that(command, is_input)) {
        CommandLine line;
        line.fault_of(words(names, command, {{input, path}}));
        EXPECT_THROW(require_files_or_folders(line.command({})), InputError) << joined(names) << input->get_name();
      }
    }
    EXPECT_EQ(run("evaluate --estimate " + path + " --truth " + path).exit_code, 3);
    EXPECT_EQ(run("map " + path + " -o out.byre").exit_code, 3);
    EXPECT_EQ(run("inspect " + path).exit_code, 3);
  }
}

TEST_F(FileArguments, NumbersMustBeFinite) {
  CommandLine line;
  for (const std::vector<std::string>& names : line.commands()) {
    for (CLI::Option* const option : options_that(line.command(names), [](auto& o) { return takes_a_value(o); })) {
      if (is_input(*option) || is_output(*option) || is_text(*option)) continue;
      for (const char* const number : {"nan", "-nan", "inf", "-inf", "1e999", "0:inf", "nan:1"}) {
        EXPECT_FALSE(accepts(*option, number)) << joined(names) << option->get_name() << " " << number;
      }
    }
  }
}

TEST_F(FileArguments, NumbersAreDocumentedWithoutMachineLimits) {
  CommandLine line;
  for (const std::vector<std::string>& names : line.commands()) {
    EXPECT_THAT(line.command(names).help(), testing::Not(HasSubstr("e+308"))) << joined(names);
    for (CLI::Option* const option : options_that(line.command(names), [](auto& o) { return takes_a_value(o); })) {
      option->add_result("-12345.5");
      try {
        option->run_callback();
      } catch (const CLI::Error& error) {
        EXPECT_THAT(error.what(), AllOf(testing::Not(HasSubstr("e+308")), testing::Not(HasSubstr("e-308"))))
            << joined(names) << option->get_name();
      }
    }
  }
}

}  // namespace
}  // namespace byre::cli
