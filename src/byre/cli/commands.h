#pragma once

#include <functional>
#include <iosfwd>

namespace CLI {
class App;
}

namespace byre::cli {

// What the program ends with; when it was interrupted, with 128 and the signal's number (130: Ctrl-C).
enum ExitCode : int { done = 0, failed = 1, wrong_usage = 2, bad_input = 3, interrupted = 130 };

// Does what a command is for, with the options it was given, and writes its result. Throws InputError for bad input and
// any other exception for a failure at work. Gives interrupted when it was stopped by a signal, else done.
using Action = std::function<ExitCode(std::ostream& result)>;

// Declares all commands; the one on the command line becomes the action when that is parsed.
void declare_commands(CLI::App& app, Action& action);

// Each declares the options of a command, and lives in a folder of its name. The action is to be called once
// the command line is parsed.
Action declare_demo(CLI::App& command);
Action declare_map(CLI::App& command);
Action declare_run(CLI::App& command);
Action declare_bag(CLI::App& command);
Action declare_camera(CLI::App& command);
Action declare_check(CLI::App& command);
Action declare_calibrate(CLI::App& command);
Action declare_refine(CLI::App& command);
Action declare_scale(CLI::App& command);
Action declare_evaluate(CLI::App& command);
Action declare_benchmark(CLI::App& command);
Action declare_localise(CLI::App& command);
Action declare_node(CLI::App& command);  // where byre is built with ROS 2
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
