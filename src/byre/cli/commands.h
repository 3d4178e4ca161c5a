#pragma once

#include <functional>
#include <initializer_list>
#include <iosfwd>

namespace CLI {
class App;
}

namespace byre::cli {

// Exit codes of the program. If interrupted: 128 plus the signal's number (130: Ctrl-C).
enum ExitCode : int { done = 0, failed = 1, wrong_usage = 2, bad_input = 3, interrupted = 130 };

// Runs a command with its parsed options, and writes its result. Throws InputError for bad input, and any other
// exception for a failure. Returns interrupted if stopped by a signal, else done.
using Action = std::function<ExitCode(std::ostream& result)>;

struct Command {
  const char* name;
  const char* summary;
  Action (*declare)(CLI::App& command);
  const char* alias = nullptr;  // another usual spelling
};

// Declares subcommands, one of which is required. Call the returned action after parsing.
Action declare_subcommands(CLI::App& command, std::initializer_list<Command> subcommands);

// Declares all commands; parsing sets the action of the one given.
void declare_commands(CLI::App& app, Action& action);

// Each declares the options of a command, in the folder of its name. Call the returned action after parsing. A command
// that needs a library absent from this build fails with an error (absent.cc).
Action declare_demo(CLI::App& command);
Action declare_map(CLI::App& command);
Action declare_run(CLI::App& command);
Action declare_bag(CLI::App& command);
Action declare_camera(CLI::App& command);
Action declare_check(CLI::App& command);
Action declare_calibrate(CLI::App& command);
Action declare_calibration(CLI::App& command);
Action declare_refine(CLI::App& command);
Action declare_update(CLI::App& command);
Action declare_history(CLI::App& command);
Action declare_diff(CLI::App& command);
Action declare_merge(CLI::App& command);
Action declare_cut(CLI::App& command);
Action declare_scale(CLI::App& command);
Action declare_evaluate(CLI::App& command);
Action declare_benchmark(CLI::App& command);
Action declare_localise(CLI::App& command);
Action declare_node(CLI::App& command);
Action declare_registry(CLI::App& command);
Action declare_worker(CLI::App& command);
Action declare_register(CLI::App& command);
Action declare_draw(CLI::App& command);
Action declare_view(CLI::App& command);
Action declare_inspect(CLI::App& command);
Action declare_validate(CLI::App& command);
Action declare_vocabulary(CLI::App& command);
Action declare_simulate(CLI::App& command);
Action declare_import_colmap(CLI::App& command);
Action declare_export_colmap(CLI::App& command);
Action declare_completion(CLI::App& command);

}  // namespace byre::cli
