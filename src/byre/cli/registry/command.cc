#include "byre/cli/registry/commands.h"

#include "byre/cli/shared/file_arguments.h"

#include <array>
#include <memory>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct RegistryCommand {
  const char* name;
  const char* summary;
  Action (*declare)(CLI::App& command);
};

constexpr std::array kRegistryCommands = {
    RegistryCommand{"init", "Make a database a registry, and add sites", declare_registry_init},
    RegistryCommand{"migrate", "Update the schema of a registry to that of this byre", declare_registry_migrate},
    RegistryCommand{"admit", "Give an account a role: robot of a site, reviewer or worker", declare_registry_admit},
    RegistryCommand{"push", "Propose maps, add sessions of missions and floor plans", declare_registry_push},
    RegistryCommand{"pull", "Write the accepted version of a site's map, or its floor plan", declare_registry_pull},
    RegistryCommand{"list", "List sites, or versions, open sessions and jobs of a site", declare_registry_list},
    RegistryCommand{"show", "Show a version with its sessions and reviews, or plans", declare_registry_show},
    RegistryCommand{"accept", "Accept a proposed version for all robots of the site", declare_registry_accept},
    RegistryCommand{"reject", "Reject a proposed version", declare_registry_reject},
    RegistryCommand{"rollback", "Accept an earlier version again", declare_registry_rollback},
    RegistryCommand{"request", "Request an update, a merge, a map or a summary of a site", declare_registry_request},
    RegistryCommand{"history", "Print who did what at a site, and why", declare_registry_history},
    RegistryCommand{"watch", "Print a line for each version of a site that is accepted", declare_registry_watch},
    RegistryCommand{"metrics", "Print the state of all sites and robots for Prometheus", declare_registry_metrics},
    RegistryCommand{"serve", "Review versions of maps in a browser", declare_registry_serve},
};

}  // namespace

void add_registry(CLI::App& command, std::string& uri) {
  add_text(command, "--registry", uri, "PostgreSQL database, postgresql://HOST/DATABASE (PGHOST, PGSERVICE, ...)")
      ->type_name("URI");
}

void add_site(CLI::App& command, std::string& site) {
  add_text(command, "SITE", site, "Name of the site")->type_name("SITE")->required();
}

CLI::Option* add_version_id(CLI::App& command, std::string& id) {
  return add_text(command, "VERSION", id, "Id of the version, as in \"byre history\"")->type_name("ID")->required();
}

void add_reason(CLI::App& command, std::string& reason) {
  add_text(command, "--reason", reason, "Reason, for the history of the site")->type_name("TEXT");
}

Action declare_registry(CLI::App& command) {
  const auto chosen = std::make_shared<Action>();
  command.require_subcommand(1);
  for (const RegistryCommand& each : kRegistryCommands) {
    CLI::App* const declared = command.add_subcommand(each.name, each.summary);
    declared->callback([chosen, run = each.declare(*declared)] { *chosen = run; });
  }
  return [chosen](std::ostream& result) { return (*chosen)(result); };
}

}  // namespace byre::cli
