#include "byre/base/printable.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/progress.h"
#include "byre/features/image_threads.h"
#include "byre/ros2/node/node.h"
#include "byre/ros2/node/process.h"
#include "byre/ros2/node/ros_arguments.h"

#include <array>
#include <chrono>
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct NodeOptions {
  std::optional<std::filesystem::path> config;
  bool has_ros_arguments = false;
  RosArguments ros;
  std::string log_level;    // empty: all
  std::string unsupported;  // value of an argument without an effect
  bool has_unsupported = false;
  std::string distribution;  // empty: from the environment
  bool check = false;
  bool quiet = false;
};

constexpr const char* kNodeFooter = R"(Examples:
  byre node --print-config > robot.yaml
  byre node --config robot.yaml --check
  byre node --config robot.yaml
  ROS_DOMAIN_ID=7 byre node --config robot.yaml --ros-distro humble
  byre node --config robot.yaml --ros-args -r __ns:=/robot1 -r /tf:=tf -p slam.save:=today.byre

The ROS 2 node needs no ROS installation: it communicates by Cyclone DDS. It uses ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY,
ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS, ROS_DISTRO, RMW_IMPLEMENTATION and CYCLONEDDS_URI. It runs until it
is stopped (Ctrl-C, SIGTERM), then saves the map. docs/reference/ros2.md describes topics, frames and settings.

Exit codes: 0 stopped, or --check found no fault, 1 failed at run time, 3 settings or files that cannot be used.)";

// Arguments of ROS 2 without an effect on this node.
constexpr std::array kUnsupportedValues = {"-e,--enclave", "--log-config-file", "--log-file-name"};
constexpr std::array kUnsupportedFlags = {"--enable-rosout-logs",       "--disable-rosout-logs",
                                          "--enable-stdout-logs",       "--disable-stdout-logs",
                                          "--enable-external-lib-logs", "--disable-external-lib-logs"};

NodeConfigReading reading_of(const NodeOptions& options) {
  if (options.has_unsupported || !options.unsupported.empty()) {
    throw InputError("--ros-args", "has an argument without an effect on this node",
                     "give -r, -p, --params-file or --log-level");
  }
  if (!options.config && options.ros.empty()) {
    throw InputError("--config", "is missing", "give a settings file as printed by --print-config");
  }
  return read_node_config(options.config, options.ros);
}

NodeConfig sound_config(const NodeOptions& options) {
  NodeConfigReading reading = reading_of(options);
  if (!reading.faults.empty()) throw InputError(reading.faults.front());
  return reading.config;
}

// Reports all faults, not only the first.
ExitCode check(const NodeOptions& options, std::ostream& result) {
  NodeConfigReading reading = reading_of(options);
  std::vector<InputError> faults = std::move(reading.faults);
  std::vector<std::string> notes;
  if (faults.empty()) faults = faults_in_files(reading.config, notes);
  show_warnings(std::cerr, notes);
  for (const InputError& fault : faults) std::cerr << "byre: error: " << fault.what() << "\n";
  if (!faults.empty()) return ExitCode::bad_input;
  result << (options.config ? printable(options.config->string()) : "byre node") << ": no fault found\n";
  return ExitCode::done;
}

RosNetwork network_of(const NodeOptions& options) {
  RosNetwork network = read_ros_network(program_environment());
  if (options.distribution.empty()) return network;
  const auto distribution = distribution_of(options.distribution);
  if (!distribution)
    throw InputError("--ros-distro", "is not a release of ROS 2", "give a release such as humble or jazzy");
  network.distribution = *distribution;
  return network;
}

LogLevel least_severe(const NodeOptions& options, const NodeConfig& config) {
  if (options.log_level.empty()) return LogLevel::info;
  const auto level = log_level_of(options.log_level, config.name);
  if (level) return *level;
  throw InputError("--log-level " + options.log_level, "is not a level of this node",
                   "give debug, info, warn, error or fatal");
}

ExitCode run_node(const NodeOptions& options, std::ostream& result) {
  if (options.check) return check(options, result);
  const NodeConfig config = sound_config(options);
  const LogLevel most = least_severe(options, config);
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  NodeLogger logger(std::cerr, is_connected_to_journal());
  const NodeLog log = [&logger, is_quiet = options.quiet, most](LogLevel level, const std::string& line) {
    if (!is_quiet && level <= most) logger.log(level, line, std::chrono::steady_clock::now().time_since_epoch());
  };
  apply_process_settings(config, log);
  Node node(config, network_of(options), program_environment()("CYCLONEDDS_URI").value_or(""), log);
  node.run([&interrupt] { return interrupt.caught(); });
  return ExitCode::done;
}

// Arguments of `ros2 run` and of launch files. CLI11 has no option whose values begin with a dash, so each is an
// option.
void declare_ros_arguments(CLI::App& command, const std::shared_ptr<NodeOptions>& options) {
  constexpr const char* kGroup = "Arguments of ROS 2";
  CLI::Option* const marker =
      command.add_flag("--ros-args", options->has_ros_arguments, "Marks the arguments of ROS 2 below")->group(kGroup);
  const auto declare = [&](CLI::Option* option, const char* type) {
    option->type_name(type)->allow_extra_args(false)->needs(marker)->group(kGroup);
  };
  declare(add_text(command, "-r,--remap", options->ros.remaps, "Topic, or node name and namespace: __node:=, __ns:="),
          "FROM:=TO");
  declare(add_text(command, "-p,--param", options->ros.parameters, "Setting, such as slam.map:=barn.byre"),
          "NAME:=VALUE");
  declare(add_input(command, Input::file, "--params-file", options->ros.parameter_files,
                    "Settings below NODE: ros__parameters:"),
          "YAML");
  declare(add_text(command, "--log-level", options->log_level, "debug, info, warn, error or fatal"), "LEVEL");
  for (const char* const name : kUnsupportedValues) add_text(command, name, options->unsupported, "")->group("");
  for (const char* const name : kUnsupportedFlags) command.add_flag(name, options->has_unsupported, "")->group("");
}

}  // namespace

Action declare_node(CLI::App& command) {
  const auto options = std::make_shared<NodeOptions>();
  add_input(command, Input::file, "--config", options->config, "Settings file as printed by --print-config")
      ->type_name("YAML");
  add_text(command, "--ros-distro", options->distribution,
           "ROS 2 release of the other programs: humble or earlier, or any later one (ROS_DISTRO, else jazzy)")
      ->type_name("NAME");
  command.add_flag("--check", options->check, "Report faults of the settings and of the files in them, and exit");
  command.add_flag("--quiet", options->quiet, "Write no log to the standard error stream");
  declare_ros_arguments(command, options);  // before the option that prints them
  const auto print = [options] {
    const bool has_settings = options->config || !options->ros.empty();
    std::cout << node_config_file(has_settings ? sound_config(*options) : NodeConfig{}) << std::flush;
    if (!std::cout) throw std::runtime_error("the settings cannot be written to the standard output");
    throw CLI::Success();
  };
  command.add_flag_callback("--print-config", print, "Print the resulting values of all settings as YAML, and exit");
  command.footer(kNodeFooter);
  return [options](std::ostream& result) { return run_node(*options, result); };
}

}  // namespace byre::cli
