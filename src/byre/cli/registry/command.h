#pragma once

#include "byre/cli/commands.h"
#include "byre/registry/connection.h"

#include <string>

namespace byre::cli {

// Declare the subcommands of `byre registry`.
Action declare_registry_init(CLI::App& command);
Action declare_registry_migrate(CLI::App& command);
Action declare_registry_admit(CLI::App& command);
Action declare_registry_push(CLI::App& command);
Action declare_registry_pull(CLI::App& command);
Action declare_registry_list(CLI::App& command);
Action declare_registry_show(CLI::App& command);
Action declare_registry_accept(CLI::App& command);
Action declare_registry_reject(CLI::App& command);
Action declare_registry_rollback(CLI::App& command);
Action declare_registry_request(CLI::App& command);
Action declare_registry_history(CLI::App& command);
Action declare_registry_watch(CLI::App& command);
Action declare_registry_metrics(CLI::App& command);
Action declare_registry_serve(CLI::App& command);

void add_registry(CLI::App& command, std::string& uri);           // --registry
void add_site(CLI::App& command, std::string& site);              // SITE
CLI::Option* add_version_id(CLI::App& command, std::string& id);  // VERSION
void add_reason(CLI::App& command, std::string& reason);          // --reason

}  // namespace byre::cli
