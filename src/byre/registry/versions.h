#pragma once

#include "byre/registry/connection.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// Versions of maps and sessions in a registry. An id is that of a map file, see map_id().

// Number of a site. Throws InputError for a site that is not there, or that the account may not read.
std::int64_t site_number(Connection& connection, const std::string& name);

struct PushedFile {
  std::string id;
  bool is_session = false;
  bool is_new = false;  // false: it was there
};

// Stores a map as a proposed version, or a session. Idempotent. note: of a version.
PushedFile push_file(Connection& connection, std::int64_t site, const std::filesystem::path& path,
                     const std::string& note);

// Adds a proposed version of a stored file. Returns whether it is new.
bool add_version(Connection& connection, std::int64_t site, const std::string& id, std::span<const std::byte> blob,
                 const std::vector<std::string>& parents, const std::string& note);
bool add_session(Connection& connection, std::int64_t site, const std::string& id, std::span<const std::byte> blob,
                 const std::string& ran_on, const std::string& name);

// Ids of the versions that a map was made of, the newest first, without its own.
std::vector<std::string> parents_of(const std::filesystem::path& map);

struct PulledMap {
  std::string id;
  std::size_t received = 0;  // bytes; 0: the path had the version already
};

// Writes a version, by default the accepted one.
PulledMap pull_map(Connection& connection, std::int64_t site, const std::optional<std::string>& id,
                   const std::filesystem::path& path);
void pull_session(Connection& connection, std::int64_t site, const std::string& id, const std::filesystem::path& path);

// Id of the accepted version, if any.
std::optional<std::string> accepted_version(Connection& connection, std::int64_t site);

}  // namespace byre
