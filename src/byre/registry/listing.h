#pragma once

#include "byre/registry/connection.h"

#include <cstdint>
#include <string>

namespace byre {

// Contents of a registry as the account may read them, as JSON text. Times are UTC.

std::string sites_json(Connection& connection);  // list of sites with numbers of versions, sessions and jobs
// Versions, open sessions, and jobs that are not done, the newest first.
std::string site_json(Connection& connection, std::int64_t site);
// A version with its sessions and events. Throws InputError for an unknown one.
std::string version_json(Connection& connection, std::int64_t site, const std::string& id);
std::string events_json(Connection& connection, std::int64_t site);  // the newest first

}  // namespace byre
