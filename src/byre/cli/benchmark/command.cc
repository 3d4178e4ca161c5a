#include "byre/base/output_file.h"
#include "byre/base/printable.h"
#include "byre/base/stopwatch.h"
#include "byre/base/task_threads.h"
#include "byre/benchmark/benchmark_run.h"
#include "byre/benchmark/life.h"
#include "byre/benchmark/plots.h"
#include "byre/benchmark/report.h"
#include "byre/benchmark/speed.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/progress.h"
#include "byre/features/image_threads.h"
#include "byre/slam/system/option_table.h"

#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct BenchmarkCommandOptions {
  std::string protocol;
  SpeedCase speed;  // measured instead of a protocol if it names a recording
  fs::path life;    // measured instead of a protocol unless empty
  BenchmarkOptions run{.data = ".", .output = {}, .only = {}, .vocabulary = {}, .method = {}};
  MethodArguments method;
  std::optional<int> runs;
  std::optional<fs::path> vocabulary;
  bool quiet = false;

  bool is_of_speed() const { return !speed.recording.empty(); }
};

constexpr const char* kBenchmarkFooter = R"(Examples:
  byre benchmark euroc --data ~/recordings/euroc
  byre benchmark mh_short --data ~/recordings/euroc --runs 1 -o out
  byre benchmark my_barn.yaml --data /data --only "tuesday*" monday --pace live
  byre benchmark --speed ~/recordings/euroc/MH_01_easy --runs 3
  byre benchmark --speed monday --map barn.byre --camera left -o out
  byre benchmark --life life -o out

Each case of the protocol is run with each of its arms: no_map (plain SLAM), localise_only (on the map of another
recording, without mapping) and hybrid (on that map, with an online map). Maps are made once. The folder receives
benchmark.md (the printed tables), benchmark.json, plots as SVG, the maps, and the trajectories of all runs, for
"byre evaluate". Cases without their recordings are skipped.
With --life the first recording of a folder, by name, is mapped; each later one runs on the first version of the map
and on its newest version, which is then updated by that mission. life.md, life.json, life.svg and the versions are
written to the folder, also after Ctrl-C.
With --speed one recording is run, at live pace unless --pace is given. The times of the stages of a frame are
printed, with CPU time, memory, and number of instructions if the machine counts them; -o also writes speed.md and
speed.json. Ctrl-C keeps the measurements so far, with exit code 130. docs/reference/benchmark.md explains protocol
and figures.)";

// Writes the plots of the cases; returns Markdown that shows them.
std::string write_plots(const BenchmarkResult& result, const fs::path& folder) {
  std::string markdown;
  for (const CaseResult& one : result.cases) {
    if (one.arms.empty()) continue;
    const std::string name = file_name_of(one.what.name);
    write_atomically(folder / (name + "_path.svg"), to_svg(path_chart(one)));
    write_atomically(folder / (name + "_error.svg"), to_svg(error_chart(one)));
    markdown += "\n![Path of " + one.what.name + "](" + name + "_path.svg)\n";
    markdown += "\n![Error of " + one.what.name + "](" + name + "_error.svg)\n";
  }
  return markdown;
}

void write_results(const BenchmarkResult& result, const BenchmarkProtocol& protocol, const BenchmarkSetting& setting,
                   const fs::path& folder) {
  const std::string plots = write_plots(result, folder);
  write_atomically(folder / "benchmark.md", to_markdown(result, protocol, setting) + plots);
  write_atomically(folder / "benchmark.json", to_json(result, protocol, setting));
}

// Prints the current case and its progress to stderr.
class BenchmarkProgress {
 public:
  explicit BenchmarkProgress(bool quiet) : style_(progress_style(quiet)) {}

  void begin(const std::string& what, int frames) {
    end();
    watch_ = Stopwatch();
    say(what);
    progress_.emplace(std::cerr, style_, frames);
  }
  void update(int done, const PlayedFrame& frame) {
    const bool is_read = frame.report.has_value();
    progress_->update(done, watch_.seconds(), is_read ? to_string(frame.report->state) : "unreadable frame");
  }
  void end() {
    if (progress_) progress_->close();
    progress_.reset();
  }
  void say(const std::string& what) const {
    if (style_ != ProgressStyle::none) std::cerr << printable(what) << std::endl;
  }

 private:
  const ProgressStyle style_;
  Stopwatch watch_;
  std::optional<Progress> progress_;
};

void write_speed(const SpeedCase& what, const std::vector<SpeedMeasures>& runs, const fs::path& folder) {
  write_atomically(folder / "speed.md", speed_markdown(what, runs));
  write_atomically(folder / "speed.json", speed_json(what, runs));
}

ExitCode measure_speed_command(BenchmarkCommandOptions options, std::ostream& result) {
  SpeedCase& what = options.speed;
  options.method.is_live = true;
  what.method = options.method.options();
  what.vocabulary = options.vocabulary;
  what.cores = processor_count();
  const fs::path& folder = options.run.output;
  if (!folder.empty()) make_folder(folder);
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  BenchmarkProgress progress(options.quiet);
  PlayHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.after_frame = [&progress](int done, const PlayedFrame& frame) { progress.update(done, frame); };
  const int frames = open_recording(what.recording, what.range, what.open)->size();
  const int count = options.runs.value_or(1);
  std::vector<SpeedMeasures> runs;
  for (int i = 0; i < count && !interrupt.caught(); ++i) {
    progress.begin("run " + std::to_string(i + 1) + " of " + std::to_string(count), frames);
    const SpeedMeasures measured = measure_speed(what, hooks);
    if (!interrupt.caught()) runs.push_back(measured);
    if (!folder.empty()) write_speed(what, runs, folder);
  }
  progress.end();
  result << speed_markdown(what, runs);
  return interrupt.caught() ? ExitCode::interrupted : ExitCode::done;
}

void write_life(const LifeResult& result, const fs::path& folder) {
  write_atomically(folder / "life.md", life_markdown(result) + "\n![Curves over the days](life.svg)\n");
  write_atomically(folder / "life.json", life_json(result));
  if (!result.days.empty()) write_atomically(folder / "life.svg", life_plot(result));
}

ExitCode measure_life_command(const BenchmarkCommandOptions& options, std::ostream& result) {
  const LifeCase life{options.life, options.run.output.empty() ? "benchmark_life" : options.run.output,
                      options.vocabulary, options.method.options()};
  make_folder(life.output);
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  BenchmarkProgress progress(options.quiet);
  LifeHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.before_run = [&progress](const std::string& what, int frames) { progress.begin(what, frames); };
  hooks.after_frame = [&progress](int done, const PlayedFrame& frame) { progress.update(done, frame); };
  hooks.after_day = [&](const LifeResult& so_far) { write_life(so_far, life.output); };
  const LifeResult measured = measure_life(life, hooks);
  progress.end();
  write_life(measured, life.output);
  result << life_markdown(measured);
  return measured.stopped ? ExitCode::interrupted : ExitCode::done;
}

ExitCode run_benchmark_command(BenchmarkCommandOptions options, std::ostream& result) {
  const fs::path file = find_benchmark_protocol(options.protocol);
  BenchmarkProtocol protocol = read_benchmark_protocol(file);
  if (options.runs) protocol.runs = *options.runs;
  if (options.run.output.empty()) options.run.output = "benchmark_" + protocol.name;
  options.run.method = options.method.options();
  options.run.vocabulary = options.vocabulary;
  make_folder(options.run.output);
  const BenchmarkSetting setting{file.filename().string(), options.run.data.string(), options.run.method.pace,
                                 processor_count(), changed_options(options.run.method)};

  limit_image_threads(1);
  const fs::path& folder = options.run.output;
  const InterruptCatcher interrupt;
  BenchmarkProgress progress(options.quiet);
  BenchmarkHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.before_run = [&progress](const std::string& what, int frames) { progress.begin(what, frames); };
  hooks.after_frame = [&progress](int done, const PlayedFrame& frame) { progress.update(done, frame); };
  hooks.after_run = [&](const BenchmarkResult& so_far) { write_results(so_far, protocol, setting, folder); };
  hooks.on_skipped = [&progress](const SkippedCase& skipped) {
    progress.end();
    progress.say("skipped " + skipped.name + ": " + skipped.reason);
  };
  const BenchmarkResult measured = run_benchmark(protocol, options.run, hooks);
  progress.end();
  write_results(measured, protocol, setting, folder);
  result << to_markdown(measured, protocol, setting);
  return measured.stopped ? ExitCode::interrupted : ExitCode::done;
}

}  // namespace

// Options for --speed only; returns --speed.
CLI::Option* declare_speed(CLI::App& command, SpeedCase& speed) {
  CLI::Option* const recording = add_input(command, Input::recording, "--speed", speed.recording,
                                           "Measure the speed on this recording, instead of running a protocol")
                                     ->type_name("RECORDING");
  const std::size_t count_before = command.get_options().size();
  add_input(command, Input::file, "--map", speed.map, "Offline map of the mission (none: plain SLAM)")
      ->type_name("MAP");
  declare_open_options(command, speed.open);
  declare_frame_range(command, speed.range);
  const std::vector<CLI::Option*> declared = command.get_options();
  for (std::size_t i = count_before; i < declared.size(); ++i) declared[i]->needs(recording)->group("With --speed");
  return recording;
}

Action declare_benchmark(CLI::App& command) {
  constexpr int kMaxRuns = 1000;
  const auto options = std::make_shared<BenchmarkCommandOptions>();
  CLI::Option* const speed = declare_speed(command, options->speed);
  add_input(command, Input::file, "PROTOCOL", options->protocol,
            "Protocol file, or a built-in protocol: euroc, twin, mh_short")
      ->type_name("FILE|NAME")
      ->excludes(speed);
  add_input(command, Input::folder, "--life", options->life,
            "Measure a map over the recordings of this folder, updated after each")
      ->excludes(speed)
      ->excludes("PROTOCOL");
  add_input(command, Input::folder, "--data", options->run.data, "Folder of the protocol's recordings (.)")
      ->excludes(speed);
  add_output(command, Output::folder, "-o,--output", options->run.output,
             "Folder for results, created if missing (benchmark_PROTOCOL, benchmark_life; with --speed none)");
  command
      .add_option("--runs", options->runs,
                  "Runs of each arm, replaces the protocol's number; with --speed runs of the recording (1)")
      ->type_name("N")
      ->check(between(1, kMaxRuns));
  add_text(command, "--only", options->run.only, "Run only these cases")->type_name("CASE...")->excludes(speed);
  declare_pace(command, options->method);
  declare_vocabulary_option(command, options->vocabulary);
  declare_options_file(command, options->method);
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kBenchmarkFooter);
  check_when_parsed(command, [options = options.get()] {
    require_valid(options->speed.range);
    const bool is_given = !options->protocol.empty() || options->is_of_speed() || !options->life.empty();
    if (!is_given) throw CLI::RequiredError("PROTOCOL, --speed or --life");
  });
  return [options](std::ostream& result) {
    if (options->is_of_speed()) return measure_speed_command(*options, result);
    if (!options->life.empty()) return measure_life_command(*options, result);
    return run_benchmark_command(*options, result);
  };
}

}  // namespace byre::cli
