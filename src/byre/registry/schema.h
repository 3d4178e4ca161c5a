#pragma once

#include "byre/registry/connection.h"

#include <chrono>
#include <optional>
#include <string>

namespace byre {

// Schema that this client is made for: the newest file of share/byre/registry.
inline constexpr int kRegistrySchema = 5;

// Schema of a database; 0: it is no registry.
int registry_schema(Connection& connection);

// Applies the files of later schemas, each in a transaction. Returns the schema before. Throws InputError for a
// database that a newer client made.
int migrate_registry(Connection& connection);

// Connects to a registry, see Connection. Throws InputError if its schema is older than kRegistrySchema, or does not
// admit clients made for kRegistrySchema.
Connection open_registry(const std::string& uri, std::optional<std::chrono::seconds> patience = {});

}  // namespace byre
