#include "byre/base/printable.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/warnings.h"
#include "byre/features/image_threads.h"
#include "byre/ros2/node/node.h"
#include "byre/ros2/node/process.h"

#include <chrono>
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct NodeOptions {
  std::optional<std::filesystem::path> config;
  std::string distribution;  // empty: from the environment
  bool check = false;
  bool quiet = false;
};

constexpr const char* kNodeFooter = R"(Examples:
  byre node --print-config > robot.yaml
  byre node --config robot.yaml --check
  byre node --config robot.yaml
  ROS_DOMAIN_ID=7 byre node --config robot.yaml --ros-distro humble

The ROS 2 node needs no ROS installation: it communicates by Cyclone DDS. It uses ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY,
ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS, ROS_DISTRO, RMW_IMPLEMENTATION and CYCLONEDDS_URI. It runs until it
is stopped (Ctrl-C, SIGTERM), then saves the map. docs/reference/ros2.md describes topics, frames and settings.

Exit codes: 0 stopped, or --check found no fault, 1 failed at run time, 3 settings or files that cannot be used.)";

NodeConfig sound_config(const NodeOptions& options) {
  if (!options.config) throw InputError("--config", "is missing", "give a settings file as printed by --print-config");
  NodeConfigReading reading = read_node_config(*options.config);
  if (!reading.faults.empty()) throw InputError(reading.faults.front());
  return reading.config;
}

// Reports all faults, not only the first.
ExitCode check(const std::filesystem::path& path, std::ostream& result) {
  NodeConfigReading reading = read_node_config(path);
  std::vector<InputError> faults = std::move(reading.faults);
  std::vector<std::string> notes;
  if (faults.empty()) faults = faults_in_files(reading.config, notes);
  show_warnings(std::cerr, notes);
  for (const InputError& fault : faults) std::cerr << "byre: error: " << fault.what() << "\n";
  if (!faults.empty()) return ExitCode::bad_input;
  result << printable(path.string()) << ": no fault found\n";
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

ExitCode run_node(const NodeOptions& options, std::ostream& result) {
  if (options.check && options.config) return check(*options.config, result);
  const NodeConfig config = sound_config(options);
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  NodeLogger logger(std::cerr, is_connected_to_journal());
  const NodeLog log = [&logger, is_quiet = options.quiet](LogLevel level, const std::string& line) {
    if (!is_quiet) logger.log(level, line, std::chrono::steady_clock::now().time_since_epoch());
  };
  apply_process_settings(config, log);
  Node node(config, network_of(options), program_environment()("CYCLONEDDS_URI").value_or(""), log);
  node.run([&interrupt] { return interrupt.caught(); });
  return ExitCode::done;
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
  const auto print = [options] {
    std::cout << node_config_file(options->config ? sound_config(*options) : NodeConfig{}) << std::flush;
    if (!std::cout) throw std::runtime_error("the settings cannot be written to the standard output");
    throw CLI::Success();
  };
  command.add_flag_callback("--print-config", print, "Print the resulting values of all settings as YAML, and exit");
  command.footer(kNodeFooter);
  return [options](std::ostream& result) { return run_node(*options, result); };
}

}  // namespace byre::cli
