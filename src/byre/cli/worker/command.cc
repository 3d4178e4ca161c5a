#include "byre/cli/registry/command.h"
#include "byre/base/printable.h"
#include "byre/base/text_file.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/run_input.h"
#include "byre/features/image_threads.h"
#include "byre/floor_plan.h"
#include "byre/input_error.h"
#include "byre/playback/archive/register_map.h"
#include "byre/registry/blobs.h"
#include "byre/registry/jobs.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <ostream>
#include <semaphore>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct WorkerOptions {
  std::string uri;
  std::string name;
  std::optional<fs::path> scratch;
  std::optional<fs::path> vocabulary;
  QueueOptions queue;
  bool once = false;
  bool quiet = false;
};

constexpr const char* kWorkerFooter = R"(Examples:
  byre worker --registry postgresql://worker_1@db.example.org/byre
  byre worker --once --kinds update merge

Takes jobs, one at a time: updates of sites by their sessions, as "byre update", merges, as "byre merge", recordings to
map, as "byre map", which the worker must be able to read, and versions to summarise. A result becomes a proposed
version. Any number of workers may run, on any number of computers; a site has one job at a time. The
job of a worker that ends or loses the server is taken again when its lease ends. A job that fails waits 10 s, then
twice as long each time, and is set aside after --attempts ("byre registry list SITE").
Ctrl-C ends the worker after the present step of its job, which is then taken again. --once ends it when no job is due.)";

constexpr const char* kFolderPrefix = "byre_worker.";  // before the number of the process

// Renews the lease of a job while it lives, on a connection and a thread of its own.
class LeaseKeeper {
 public:
  LeaseKeeper(const WorkerOptions& options, const RegistryJob& job)
      : thread_([this, &options, job] { renew(options, job); }) {}
  ~LeaseKeeper() { stop_.release(); }
  LeaseKeeper(const LeaseKeeper&) = delete;
  LeaseKeeper& operator=(const LeaseKeeper&) = delete;

 private:
  void renew(const WorkerOptions& options, const RegistryJob& job) {
    std::optional<Connection> connection;
    while (!stop_.try_acquire_for(std::chrono::milliseconds(1000 * options.queue.lease_s / 3))) {
      try {
        if (!connection) connection.emplace(options.uri);
        if (!renew_lease(*connection, job, options.queue)) return;  // end_job() reports the loss
      } catch (const std::exception&) {
        connection.reset();  // the server may be back at the next time
      }
    }
  }

  std::binary_semaphore stop_{0};
  std::jthread thread_;  // the last member: it uses the others
};

// Folder of a job, removed at the end.
class JobFolder {
 public:
  explicit JobFolder(const fs::path& scratch) : path_(scratch / fmt::format("{}{}", kFolderPrefix, getpid())) {
    fs::remove_all(path_);
    fs::create_directories(path_);
    fs::permissions(path_, fs::perms::owner_all);
  }
  ~JobFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  JobFolder(const JobFolder&) = delete;
  JobFolder& operator=(const JobFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Folders of workers that were killed.
void remove_abandoned(const fs::path& scratch) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(scratch, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kFolderPrefix)) continue;
    const auto process = parse_whole<pid_t>(std::string_view(name).substr(std::string_view(kFolderPrefix).size()));
    if (process && *process > 0 && kill(*process, 0) != 0 && errno == ESRCH) fs::remove_all(entry.path(), error);
  }
}

struct Interrupted : std::exception {};

std::string map_recording(const RegistryJob& job, const fs::path& map, const std::optional<fs::path>& vocabulary,
                          const InterruptCatcher& interrupt) {
  RunInputOptions source;
  source.recording = job.recording;
  if (!job.calibration.empty()) source.open.calibration = job.calibration;
  source.quiet = true;
  RunInput input(source, false);
  SlamOptions options = slam_options(MethodOptions());
  options.recording = input.name();
  options.vocabulary = vocabulary;
  Slam slam = Slam::mapping(input.calibration(), options);
  RunResult run = input.play(slam, {}, interrupt);
  if (interrupt.caught()) throw Interrupted();
  require_frames(run);
  require_poses(run, {});
  const SlamInputs& inputs = slam.impl().inputs();
  save_for_missions_and_reload(run.stored, *inputs.vocabulary, inputs.site, map);
  return fmt::format("{} mapped: {} of {} frames, {} keyframes, {} points", options.recording, run.final.size(),
                     run.frames.size(), run.stored.map.keyframe_count(), run.stored.map.point_count());
}

// Registers a map by its walls on the current plan of the site that it fits, and writes it again. Returns the result in
// words; empty for a site without plans.
std::string register_on_plan(Connection& connection, std::int64_t site, const fs::path& map) {
  StoredMap stored = load_map(map);
  std::vector<PlanRegistration> found;
  std::string refusals;
  for (const RegistryPlan& plan : current_plans(connection, site)) {
    try {
      const fs::path folder = map.parent_path() / fmt::format("plan_{}", plan.file);
      const fs::path pulled = pull_plan(connection, site, plan, folder).path;
      const PlanFit fit = register_by_walls(stored, "the map", read_drawn_floor_plan(pulled), {}).fit;
      if (has_large_residual(fit))
        throw InputError("the map", fmt::format("has residuals of {:.2f} m", residual_of(fit)));
      found.push_back(fit.registration);
    } catch (const InputError& error) {
      refusals += fmt::format("; not on plan {}: {}", plan.name, error.reason());
    }
  }
  if (found.size() > 1) return "; not registered: it fits several plans";
  if (found.empty()) return refusals;
  stored.plan = found.front();
  save_map(stored, map);
  return "; registered on " + stored.plan->plan;
}

class JobRunner {
 public:
  JobRunner(const WorkerOptions& options, const InterruptCatcher& interrupt, std::ostream& result)
      : options_(options),
        interrupt_(interrupt),
        result_(result),
        scratch_(options.scratch.value_or(fs::temp_directory_path())),
        vocabulary_(open_vocabulary(options.vocabulary)),
        connection_(open_registry(options.uri)) {
    remove_abandoned(scratch_);
    connection_.run("LISTEN byre_job");
  }

  // Runs jobs until interrupted, or once none is due.
  void run() {
    bool is_broken = false;
    while (!interrupt_.caught()) {
      try {
        if (is_broken) {
          connection_.reconnect();
          connection_.run("LISTEN byre_job");
          is_broken = false;
        }
        if (const auto job = take_job(connection_, options_.name, options_.queue)) {
          run(*job);
        } else if (options_.once) {
          return;
        } else {
          wait();
        }
      } catch (const ConnectionLost& lost) {
        note(fmt::format("{}; connecting again", lost.what()));
        is_broken = true;
        std::this_thread::sleep_for(std::chrono::seconds(1));
      }
    }
  }

 private:
  // Waits for a request. Retries and ends of leases are not notified.
  void wait() {
    for (int i = 0; i < 10 && !interrupt_.caught(); ++i) {
      if (connection_.wait_for_notification(std::chrono::milliseconds(500))) return;
    }
  }

  void run(const RegistryJob& job) {
    note(fmt::format("job {}: {}, attempt {}", job.id, job.kind, job.attempt));
    const LeaseKeeper keeper(options_, job);
    try {
      const JobFolder folder(scratch_);
      const auto map = [this](const RegistryJob& of, const fs::path& path) {
        const std::string mapped = map_recording(of, path, options_.vocabulary, interrupt_);
        return mapped + register_on_plan(connection_, of.site, path);
      };
      const JobResult made = work_on(connection_, job, folder.path(), vocabulary_, map, [this, &job](const char* step) {
        if (interrupt_.caught()) throw Interrupted();
        note(fmt::format("job {}: {}", job.id, step));
      });
      switch (end_job(connection_, job, made)) {
        case JobEnd::done:
          result_ << fmt::format("job {} done: {}", job.id, printable(made.message)) << std::endl;
          break;
        case JobEnd::lost:
          note(fmt::format("job {}: its lease ended, another worker has it", job.id));
          break;
        case JobEnd::outdated:
          note(fmt::format("job {}: another version was accepted meanwhile", job.id));
          break;
      }
    } catch (const ConnectionLost&) {
      throw;  // the job is taken again when its lease ends
    } catch (const Interrupted&) {
      fail_job(connection_, job, {.max_attempts = job.attempt + 1}, "the worker was stopped");
    } catch (const std::exception& error) {
      result_ << fmt::format("job {} failed: {}", job.id, printable(error.what())) << std::endl;
      fail_job(connection_, job, options_.queue, error.what());
    }
  }

  void note(const std::string& text) const {
    if (!options_.quiet) std::cerr << printable(text) << std::endl;
  }

  const WorkerOptions& options_;
  const InterruptCatcher& interrupt_;
  std::ostream& result_;
  fs::path scratch_;
  Vocabulary vocabulary_;
  Connection connection_;
};

std::string default_name() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return fmt::format("{}:{}", host.data(), getpid());
}

ExitCode run_worker(WorkerOptions options, std::ostream& result) {
  if (options.name.empty()) options.name = default_name();
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  JobRunner(options, interrupt, result).run();
  return interrupt.caught() ? ExitCode::interrupted : ExitCode::done;
}

}  // namespace

Action declare_worker(CLI::App& command) {
  const auto options = std::make_shared<WorkerOptions>();
  add_registry(command, options->uri);
  add_text(command, "--name", options->name, "Name in the list of jobs (HOST:PROCESS)")->type_name("NAME");
  add_output(command, Output::folder, "--scratch", options->scratch, "Folder for maps of jobs ($TMPDIR, or /tmp)");
  declare_vocabulary_option(command, options->vocabulary);
  std::map<std::string, std::string> kinds;
  for (const std::string kind : kRegistryJobKinds) kinds.emplace(kind, kind);
  command.add_option("--kinds", options->queue.kinds, "Kinds of jobs to take (all)")
      ->type_name("update|merge|map|summarise")
      ->transform(one_of(kinds));
  command.add_option("--lease", options->queue.lease_s, "Time without a sign of life after which a job is taken again")
      ->type_name("SECONDS")
      ->check(between(1, 86400))
      ->capture_default_str();
  command.add_option("--attempts", options->queue.max_attempts, "Attempts after which a job is set aside")
      ->check(between(1, 1000))
      ->capture_default_str();
  command.add_flag("--once", options->once, "End when no job is due");
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kWorkerFooter);
  return [options](std::ostream& result) { return run_worker(*options, result); };
}

}  // namespace byre::cli
