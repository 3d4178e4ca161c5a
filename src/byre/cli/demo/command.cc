#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/benchmark/demo/animation.h"
#include "byre/benchmark/demo/demo_run.h"
#include "byre/benchmark/demo/page.h"
#include "byre/benchmark/demo/table.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/render_with_progress.h"
#include "byre/input_error.h"

#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct DemoCommandOptions {
  DemoOptions demo;
  std::optional<fs::path> animation;
  bool quiet = false;
};

constexpr const char* kDemoFooter = R"(Examples:
  byre demo
  byre demo -o ~/demo --seed 7
  byre demo --animation demo.png

Compares runs with and without a map on simulated input, in a few minutes. Two visits of a robot to a cowshed are
rendered. The first is mapped by day, and its map is registered on the floor plan. In the second the robot is switched
on at another place at dusk, and half of the objects have moved. It is run in three ways, without the start. FOLDER
receives index.html, a page that needs neither server nor network, mission.svg and mission.png with the result in one
picture, and the recordings, the map, the trajectories and further pictures. --animation writes an animated PNG: the
camera image with matched points of both maps, beside the plan with the path as it grows. Ctrl-C keeps the files written
so far, but no page. docs/tutorials/demo.md explains the page.)";

void make_new_folder(const fs::path& folder) {
  make_folder(folder);
  if (fs::exists(folder / "first_visit" / "mav0") || fs::exists(folder / "second_visit" / "mav0")) {
    throw InputError(folder.string(), "already contains a demonstration",
                     "give another folder, or remove this one first");
  }
}

ExitCode run_demo_command(const DemoCommandOptions& options, std::ostream& result) {
  make_new_folder(options.demo.output);  // may be the folder of the animation
  if (options.animation) require_writable(*options.animation, FileContent::png);
  const fs::path& folder = options.demo.output;
  const fs::path page = folder / "index.html";
  const InterruptCatcher interrupt;
  DemoHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.before_stage = [&](const std::string& stage) {
    if (!options.quiet) std::cerr << stage << std::endl;
  };
  hooks.render = [&](const CowshedRecordingOptions& visit, const fs::path& visit_folder) {
    return render_with_progress(visit, visit_folder, interrupt, options.quiet);
  };
  hooks.play = [&](Slam& slam, Recording& recording, const PlayHooks& more) {
    return play_with_progress(slam, recording, more, interrupt, options.quiet);
  };
  const std::optional<DemoFindings> findings = run_demo(options.demo, hooks);
  if (!findings) return ExitCode::interrupted;
  write_picture(findings->mission_picture, folder / "mission.svg");
  write_picture(findings->mission_picture, folder / "mission.png");
  write_atomically(folder / "plan.svg", findings->plan_picture);
  if (findings->camera_s) write_atomically(folder / "camera.svg", findings->camera_picture);
  write_atomically(page, demo_page(*findings));
  if (options.animation) {
    write_atomically(*options.animation, to_animated_png(findings->animation, kAnimationRate, kLastAnimationFrame));
  }
  result << to_text(demo_table(findings->arms), findings->arms) << "\n";
  if (options.animation) result << row("animation", options.animation->string());
  result << row("page", page.string());
  return ExitCode::done;
}

}  // namespace

Action declare_demo(CLI::App& command) {
  const auto options = std::make_shared<DemoCommandOptions>();
  add_output(command, Output::folder, "-o,--output", options->demo.output,
             "Folder for the page and its data (byre_demo)");
  command.add_option("--seed", options->demo.seed, "Seed of the barn")->type_name("N")->capture_default_str();
  command
      .add_option("--duration", options->demo.duration_s, "Duration of the first visit; the second is a quarter longer")
      ->type_name("SECONDS")
      ->check(between(1.0, 3600.0))
      ->capture_default_str();
  command.add_option("--rate", options->demo.frame_rate_hz, "Stereo pairs per second")
      ->type_name("HZ")
      ->check(between(1.0, 60.0))
      ->capture_default_str();
  command
      .add_option("--divide", options->demo.image_divisor, "Divisor of the image size: 752 x 480 pixels divided by N")
      ->type_name("N")
      ->check(between(1, 8))
      ->capture_default_str();
  add_output(command, Output::picture, "--animation", options->animation, "Animated PNG of the hybrid run: .png")
      ->check([](const std::string& file) {
        return std::string(fs::path(file).extension() == ".png" ? "" : "must end in .png");
      });
  declare_vocabulary_option(command, options->demo.vocabulary);
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kDemoFooter);
  return [options](std::ostream& result) {
    options->demo.animation = options->animation.has_value();
    return run_demo_command(*options, result);
  };
}

}  // namespace byre::cli
