#include "byre/registry/versions.h"

#include "byre/base/binary_file.h"
#include "byre/base/nearest_name.h"
#include "byre/base/printable.h"
#include "byre/input_error.h"
#include "byre/registry/blobs.h"
#include "byre/slam/upkeep/update_map.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxName = 200;  // bytes; limit of the schema

void require_same_file(const Connection& connection, const Rows& same, const std::string& id) {
  if (same.size() == 1 && same.text(0, 0) == "t") return;
  throw InputError(connection.place(), "has another file with the id " + id, "compare both with byre diff");
}

// Bytes named by the first row of a statement. what: of the message without a row.
std::vector<std::byte> require_blob(Connection& connection, const char* statement,
                                    const std::vector<Parameter>& parameters, const std::string& what) {
  std::optional<std::vector<std::byte>> name;
  persist(connection, [&] { name = connection.bytes(statement, parameters); });
  if (name) return *std::move(name);
  throw InputError(connection.place(), "has no " + what + ", or the account may not read it",
                   "list the site with byre registry list");
}

constexpr std::ptrdiff_t kMaxReason = 1000;  // characters; limit of the schema

const char* statement_of(Review review) {
  switch (review) {
    case Review::accept:
      return "SELECT $2::text FROM byre.accept($1, $2, $3)";
    case Review::reject:
      return "SELECT $2::text FROM byre.reject($1, $2, $3)";
    case Review::rollback:
      break;
  }
  return "SELECT byre.rollback($1, $2, $3)";
}

void require_storable(const std::string& reason) {
  const auto continues_character = [](char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; };
  const auto characters = std::ranges::count_if(reason, std::not_fn(continues_character));
  if (characters > kMaxReason) {
    throw InputError("reason", fmt::format("has {} characters, of {} at most", characters, kMaxReason), "shorten it");
  }
  if (reason.find('\0') != std::string::npos) throw InputError("reason", "has a null character", "remove it");
}

}  // namespace

std::int64_t site_number(Connection& connection, const std::string& name) {
  const Rows found = connection.run("SELECT id FROM byre.site WHERE name = $1", {name});
  if (found.size() == 1) return found.number(0, 0);
  const Rows all = connection.run("SELECT name FROM byre.site ORDER BY name");
  std::vector<std::string> names;
  for (int row = 0; row < all.size(); ++row) names.push_back(all.text(row, 0));
  const auto nearest = nearest_name(name, names);
  throw InputError(connection.place(), "has no site '" + name + "', or the account may not see it",
                   nearest ? "did you mean '" + *nearest + "'?" : "add it with byre registry init SITE");
}

bool add_version(Connection& connection, std::int64_t site, const std::string& id, std::span<const std::byte> blob,
                 const std::vector<std::string>& parents, const std::string& note) {
  const Rows added = connection.run(
      "INSERT INTO byre.version (site, id, blob, parents, note) VALUES ($1, $2, $3, $4, $5) ON CONFLICT DO NOTHING",
      {site, id, blob, parents, note});
  if (added.changed() > 0) return true;
  require_same_file(connection,
                    connection.run("SELECT blob = $3 FROM byre.version WHERE site = $1 AND id = $2", {site, id, blob}),
                    id);
  return false;
}

bool add_session(Connection& connection, std::int64_t site, const std::string& id, std::span<const std::byte> blob,
                 const std::string& ran_on, const std::string& name) {
  const Rows added = connection.run(
      "INSERT INTO byre.session (site, id, blob, ran_on, name) VALUES ($1, $2, $3, $4, $5) ON CONFLICT DO NOTHING",
      {site, id, blob, ran_on, name});
  if (added.changed() > 0) return true;
  require_same_file(connection,
                    connection.run("SELECT blob = $3 FROM byre.session WHERE site = $1 AND id = $2", {site, id, blob}),
                    id);
  return false;
}

std::vector<std::string> parents_of(const fs::path& map) {
  std::vector<std::string> parents;
  for (const MapHistory& entry : history_of(open_map(map))) parents.push_back(to_text(entry.parent));
  return parents;
}

PushedFile push_file(Connection& connection, std::int64_t site, const fs::path& path, const std::string& note) {
  const MappedFile file(path);
  const MapUpkeep upkeep = read_upkeep(file.bytes(), path.string());
  PushedFile pushed{to_text(map_id(file.bytes(), path.string())), upkeep.session.has_value()};
  const std::vector<std::string> parents = parents_of(path);
  const std::vector<std::byte> blob = push_blob(connection, file.bytes());
  persist(connection, [&] {
    pushed.is_new = upkeep.session ? add_session(connection, site, pushed.id, blob, to_text(upkeep.session->map_id),
                                                 printable(path.stem().string(), kMaxName))
                                   : add_version(connection, site, pushed.id, blob, parents, note);
  });
  return pushed;
}

std::optional<std::string> accepted_version(Connection& connection, std::int64_t site) {
  const Rows rows = connection.run("SELECT id FROM byre.version WHERE site = $1 AND state = 'accepted'", {site});
  return rows.size() == 0 ? std::nullopt : std::optional(rows.text(0, 0));
}

PulledMap pull_map(Connection& connection, std::int64_t site, const std::optional<std::string>& id,
                   const fs::path& path) {
  PulledMap pulled;
  persist(connection, [&] { pulled.id = id ? *id : accepted_version(connection, site).value_or(""); });
  const std::string what = pulled.id.empty() ? "accepted version of this site" : "version " + pulled.id;
  const auto blob =
      require_blob(connection, "SELECT blob FROM byre.version WHERE site = $1 AND id = $2", {site, pulled.id}, what);
  pulled.received = pull_blob(connection, blob, pulled.id, path);
  return pulled;
}

void pull_session(Connection& connection, std::int64_t site, const std::string& id, const fs::path& path) {
  const auto blob = require_blob(connection, "SELECT blob FROM byre.session WHERE site = $1 AND id = $2", {site, id},
                                 "session " + id);
  pull_blob(connection, blob, id, path);
}

std::string review_version(Connection& connection, Review review, std::int64_t site,
                           const std::optional<std::string>& version, const std::string& reason) {
  require_storable(reason);
  return connection.run(statement_of(review), {site, version, reason}).text(0, 0);
}

ReviewTrial try_review(Connection& connection, Review review, std::int64_t site,
                       const std::optional<std::string>& version) {
  try {
    const Transaction rolled_back(connection);
    return {review_version(connection, review, site, version, ""), ""};
  } catch (const InputError& error) {
    return {"", error.remedy().empty() ? error.reason() : error.reason() + " (" + error.remedy() + ")"};
  }
}

}  // namespace byre
