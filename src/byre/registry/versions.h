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

// Reviews of the versions of a site, by the functions of the schema, which hold their rules.

enum class Review : std::uint8_t { accept, reject, rollback };

// Changes the state of a version. version: empty only for a rollback to the one accepted before. Returns the id of the
// accepted or rejected version. Throws InputError for a reason of more than 1000 characters, and for what the server
// refuses.
std::string review_version(Connection& connection, Review review, std::int64_t site,
                           const std::optional<std::string>& version, const std::string& reason);

struct ReviewTrial {
  std::string version;  // version that would be accepted or rejected
  std::string refusal;  // reason and remedy; empty: permitted
};

// Result that a review would have now. Changes nothing: its transaction is rolled back.
ReviewTrial try_review(Connection& connection, Review review, std::int64_t site,
                       const std::optional<std::string>& version);

}  // namespace byre
