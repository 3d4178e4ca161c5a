#include "byre/registry/schema.h"

#include "byre/base/binary_file.h"
#include "byre/base/data_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace byre {
namespace {

// Clients for earlier schemas than this one cannot use the present one.
constexpr int kOldestClient = 2;

[[noreturn]] void refuse_newer(const Connection& connection, int schema) {
  throw InputError(connection.place(),
                   fmt::format("has schema {}, and this byre is made for schema {}", schema, kRegistrySchema),
                   "install a newer byre");
}

}  // namespace

int registry_schema(Connection& connection) {
  if (connection.run("SELECT to_regnamespace('byre')").is_null(0, 0)) return 0;
  return static_cast<int>(connection.run("SELECT coalesce(max(version), 0) FROM byre.schema_version").number(0, 0));
}

int migrate_registry(Connection& connection) {
  int before = -1;
  for (int schema = 1; schema <= kRegistrySchema; ++schema) {
    Transaction transaction(connection);
    connection.run("SELECT pg_advisory_xact_lock(hashtext('byre'))");  // one migration at a time
    const int present = registry_schema(connection);
    if (before < 0) before = present;
    if (present > kRegistrySchema) refuse_newer(connection, present);
    if (present >= schema) continue;
    const std::vector<std::byte> statements =
        read_file(find_data_file(fmt::format("registry/{}.sql", schema), "install the package byre-data"));
    connection.run_script({reinterpret_cast<const char*>(statements.data()), statements.size()});
    connection.run("INSERT INTO byre.schema_version (version, oldest_client) VALUES ($1, $2)",
                   {schema, std::min(schema, kOldestClient)});
    transaction.commit();
  }
  return before;
}

Connection open_registry(const std::string& uri, std::optional<std::chrono::seconds> patience) {
  Connection connection(uri, patience);
  const Rows rows = connection.run("SELECT max(version), max(oldest_client) FROM byre.schema_version");
  const auto schema = static_cast<int>(rows.number(0, 0));
  if (rows.number(0, 1) > kRegistrySchema) refuse_newer(connection, schema);
  if (schema < kRegistrySchema) {
    throw InputError(connection.place(),
                     fmt::format("has schema {}, and this byre needs schema {}", schema, kRegistrySchema),
                     "update it with byre registry migrate");
  }
  return connection;
}

}  // namespace byre
