#pragma once

#include "byre/registry/connection.h"

#include <cstdint>
#include <optional>
#include <string>

namespace byre {

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
