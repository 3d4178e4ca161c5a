#include "byre/base/report_row.h"
#include "byre/cli/registry/commands.h"
#include "byre/cli/shared/choice.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/registry/schema.h"
#include "byre/registry/versions.h"

#include <memory>
#include <ostream>
#include <stdexcept>
#include <vector>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct InitOptions {
  std::string uri;
  std::vector<std::string> sites;
};

struct AdmitOptions {
  std::string uri;
  std::string account;
  std::string role;
  std::optional<std::string> site;
};

constexpr const char* kInitFooter = R"(Examples:
  byre registry init barn annex --registry postgresql://admin@db.example.org/byre
  byre registry init stable

Makes the schema "byre" in the database, as its owner, unless it is there, and adds sites that are not there. Accounts
get their roles by "byre registry admit". What is in the database, and who may do what: docs/reference/registry.md.)";

constexpr const char* kMigrateFooter = R"(Example:
  byre registry migrate --registry postgresql://admin@db.example.org/byre

Applies the changes of the schema that are newer than the registry, each in a transaction. Clients that are too old for
the result are refused from then on. Make a backup first (pg_dump).)";

constexpr const char* kAdmitFooter = R"(Examples:
  byre registry admit robot_1 robot --site barn
  byre registry admit ann reviewer
  byre registry admit worker_1 worker

Creates the account without a password if it is missing; give it one by \password of psql, or use certificates. A robot
reads accepted versions of its site and adds sessions. A reviewer proposes, accepts and rejects versions. A worker runs
jobs and proposes their results. Needs an account that may create roles.)";

ExitCode run_init(const InitOptions& options, std::ostream& result) {
  Connection connection(options.uri);
  const int before = migrate_registry(connection);
  result << row("schema", fmt::format("{}{} in {}", kRegistrySchema, before == kRegistrySchema ? ", as before," : "",
                                      connection.place()));
  for (const std::string& site : options.sites) {
    const Rows added = connection.run("INSERT INTO byre.site (name) VALUES ($1) ON CONFLICT DO NOTHING", {site});
    result << row("site", site + (added.changed() == 0 ? ", as before" : ""));
  }
  return ExitCode::done;
}

ExitCode run_migrate(const std::string& uri, std::ostream& result) {
  Connection connection(uri);
  if (registry_schema(connection) == 0) open_registry(uri);  // reports that it is none
  result << row("schema",
                fmt::format("{} -> {} in {}", migrate_registry(connection), kRegistrySchema, connection.place()));
  return ExitCode::done;
}

ExitCode run_admit(const AdmitOptions& options, std::ostream& result) {
  Connection connection = open_registry(options.uri);
  const std::optional<std::string> site =
      options.site ? std::optional(std::to_string(site_number(connection, *options.site))) : std::nullopt;
  connection.run("SELECT byre.admit($1, $2, $3)", {options.account, options.role, site});
  result << row(options.role, options.account + (options.site ? " of " + *options.site : ""));
  return ExitCode::done;
}

}  // namespace

Action declare_registry_init(CLI::App& command) {
  const auto options = std::make_shared<InitOptions>();
  add_text(command, "SITE", options->sites, "Sites to add")->type_name("SITE");
  add_registry(command, options->uri);
  command.footer(kInitFooter);
  return [options](std::ostream& result) { return run_init(*options, result); };
}

Action declare_registry_migrate(CLI::App& command) {
  const auto uri = std::make_shared<std::string>();
  add_registry(command, *uri);
  command.footer(kMigrateFooter);
  return [uri](std::ostream& result) { return run_migrate(*uri, result); };
}

Action declare_registry_admit(CLI::App& command) {
  const auto options = std::make_shared<AdmitOptions>();
  add_text(command, "ACCOUNT", options->account, "Account of the server")->type_name("ACCOUNT")->required();
  command.add_option("ROLE", options->role, "Role of the account")
      ->type_name("robot|reviewer|worker")
      ->transform(one_of<std::string>({{"robot", "robot"}, {"reviewer", "reviewer"}, {"worker", "worker"}}))
      ->required();
  add_text(command, "--site", options->site, "Site of the robot")->type_name("SITE");
  add_registry(command, options->uri);
  command.footer(kAdmitFooter);
  return [options](std::ostream& result) { return run_admit(*options, result); };
}

}  // namespace byre::cli
