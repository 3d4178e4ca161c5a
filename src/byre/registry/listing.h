#pragma once

#include "byre/registry/connection.h"

#include <cstdint>
#include <optional>
#include <string>

namespace byre {

// Contents of a registry as the account may read them, as JSON text. Times are UTC.

std::string sites_json(Connection& connection);  // list of sites with numbers of versions, sessions and jobs
// Versions, open sessions, and jobs that are not done, the newest first, current plans and robots.
std::string site_json(Connection& connection, std::int64_t site);
// A version with its sessions and events. Throws InputError for an unknown one.
std::string version_json(Connection& connection, std::int64_t site, const std::string& id);
// Plans of this name, or of all, by name, the newest of each first.
std::string plans_json(Connection& connection, std::int64_t site, const std::optional<std::string>& name);
std::string events_json(Connection& connection, std::int64_t site);  // the newest first

// Text that differs after any change of a version, session, plan, job or robot that the account may read. Contacts of
// robots count by minutes.
std::string listing_key(Connection& connection);

// Sites, versions, sessions, jobs and robots in the text format of Prometheus,
// https://prometheus.io/docs/instrumenting/exposition_formats
std::string registry_metrics(Connection& connection);

}  // namespace byre
