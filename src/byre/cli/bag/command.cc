#include "byre/io/bag/bag.h"

#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/playback/report/recording_report.h"

#include <filesystem>
#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct InfoOptions {
  std::filesystem::path bag;
  bool json = false;
};

constexpr const char* kInfoFooter = R"(Examples:
  byre bag info walk.mcap
  byre bag info recordings/2026-11-20
  byre bag info evening.bag --json

A bag is a rosbag2 folder, an .mcap, .db3 or a ROS 1 .bag file. All of it is read, so that damaged or truncated parts
are reported, whether the bag was closed or not. "images" are the topics that "byre map" and "byre run" use as left
and right images.

Exit codes: 0 all of it can be read, 1 a part of it cannot be read, 3 it is not a bag or cannot be opened.)";

ExitCode run_info(const InfoOptions& options, std::ostream& result) {
  const auto bag = open_bag(options.bag, [](std::string_view) { return false; });
  const BagContent& content = bag->content();
  const Report report = bag_report(content, options.bag);
  result << (options.json ? to_json(report) : report.text);
  return content.damage.empty() ? ExitCode::done : ExitCode::failed;
}

Action declare_info(CLI::App& command) {
  const auto options = std::make_shared<InfoOptions>();
  add_input(command, Input::recording, "BAG", options->bag, "rosbag2 folder, or .mcap, .db3 or .bag file")
      ->type_name("PATH")
      ->required();
  command.add_flag("--json", options->json, "Print the report as JSON");
  command.footer(kInfoFooter);
  return [options](std::ostream& result) { return run_info(*options, result); };
}

}  // namespace

Action declare_bag(CLI::App& command) {
  return declare_subcommands(command, {{"info", "Print topics, length and damage of a bag", declare_info}});
}

}  // namespace byre::cli
