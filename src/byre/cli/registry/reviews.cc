#include "byre/registry/reviews.h"
#include "byre/base/report_row.h"
#include "byre/cli/registry/commands.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/number_check.h"
#include "byre/registry/schema.h"
#include "byre/registry/versions.h"
#include "byre/slam/upkeep/place_budget.h"

#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct ReviewOptions {
  std::string uri;
  std::string site;
  std::string version;
  std::string reason;
};

struct RequestOptions {
  std::string uri;
  std::string site;
  std::vector<std::string> merged;
  std::string summarised;
  std::string recording;
  std::string calibration;
  int keyframes = kPlaceBudget;
};

constexpr const char* kAcceptFooter = R"(Example:
  byre registry accept barn 3f2a90cc51d07be4 --reason "diff looks right"

The accepted version is the one that robots pull; the one before is retired. A version that was made of others is
accepted only if the present one is among these, so that no update is lost. "byre registry pull --version" and "byre
diff" show the changes.)";

constexpr const char* kRejectFooter = R"(Example:
  byre registry reject barn 3f2a90cc51d07be4 --reason "the gate is missing"

The sessions that it was made of are not used again.)";

constexpr const char* kRollbackFooter = R"(Examples:
  byre registry rollback barn --reason "robots get lost at the feed store"
  byre registry rollback barn --version 3f2a90cc51d07be4

Retires the accepted version and accepts the one before again, or VERSION, which was accepted before.)";

constexpr const char* kRequestFooter = R"(Examples:
  byre registry request barn
  byre registry request barn --merge 3f2a90cc51d07be4 90b1c2ffe0217a6d
  byre registry request barn --map /srv/recordings/barn_day_1
  byre registry request barn --summarise 3f2a90cc51d07be4 --keyframes 6

Sessions request updates of their site themselves; a request repeats one that was set aside. A merge puts the second
version into the first. A recording is a path that workers read, on a file system that they share. A summary keeps the
most useful keyframes of each place (1 m, 0.5 rad), and those without which frames would be localised worse. "byre
worker" runs the job, whose result is a proposed version.)";

ExitCode run_review(const ReviewOptions& options, Review review, std::ostream& result) {
  Connection connection = open_registry(options.uri);
  const std::optional<std::string> version = options.version.empty() ? std::nullopt : std::optional(options.version);
  const std::int64_t site = site_number(connection, options.site);
  result << row(review == Review::reject ? "rejected" : "accepted",
                review_version(connection, review, site, version, options.reason));
  return ExitCode::done;
}

Action declare_review(CLI::App& command, Review review) {
  const auto options = std::make_shared<ReviewOptions>();
  add_site(command, options->site);
  if (review == Review::rollback) {
    add_text(command, "--version", options->version, "Another version than the one before")->type_name("ID");
  } else {
    add_version_id(command, options->version);
  }
  add_reason(command, options->reason);
  add_registry(command, options->uri);
  return [=](std::ostream& result) { return run_review(*options, review, result); };
}

ExitCode run_request(const RequestOptions& options, std::ostream& result) {
  Connection connection = open_registry(options.uri);
  const std::int64_t site = site_number(connection, options.site);
  const bool is_summary = !options.summarised.empty();
  const std::string kind = !options.recording.empty() ? "map"
                           : is_summary               ? "summarise"
                           : !options.merged.empty()  ? "merge"
                                                      : "update";
  const Rows added = connection.run(
      "INSERT INTO byre.job (site, kind, maps, recording, calibration, keyframes) VALUES ($1, $2, $3, $4, $5, $6) "
      "ON CONFLICT DO NOTHING",
      {site, kind, is_summary ? std::vector{options.summarised} : options.merged, options.recording,
       options.calibration, is_summary ? options.keyframes : 0});
  connection.run("SELECT pg_notify('byre_job', '')");
  result << row("requested", kind + (added.changed() == 0 ? ", as before" : ""));
  return ExitCode::done;
}

}  // namespace

Action declare_registry_accept(CLI::App& command) {
  command.footer(kAcceptFooter);
  return declare_review(command, Review::accept);
}

Action declare_registry_reject(CLI::App& command) {
  command.footer(kRejectFooter);
  return declare_review(command, Review::reject);
}

Action declare_registry_rollback(CLI::App& command) {
  command.footer(kRollbackFooter);
  return declare_review(command, Review::rollback);
}

Action declare_registry_request(CLI::App& command) {
  const auto options = std::make_shared<RequestOptions>();
  add_site(command, options->site);
  CLI::Option* const merge = add_text(command, "--merge", options->merged, "Merge these versions");
  merge->type_name("FIRST SECOND")->expected(2);
  CLI::Option* const map = add_text(command, "--map", options->recording, "Map this recording, a path of workers");
  map->type_name("PATH")->excludes(merge);
  add_text(command, "--calibration", options->calibration, "Calibration of the recording (its own), a path of workers")
      ->type_name("PATH")
      ->needs(map);
  CLI::Option* const summarise = add_text(command, "--summarise", options->summarised, "Reduce this version");
  summarise->type_name("ID")->excludes(merge)->excludes(map);
  command.add_option("--keyframes", options->keyframes, "Keyframes that a place keeps in the summary")
      ->check(between(1, 1000))
      ->capture_default_str()
      ->needs(summarise);
  add_registry(command, options->uri);
  command.footer(kRequestFooter);
  return [options](std::ostream& result) { return run_request(*options, result); };
}

}  // namespace byre::cli
