#include "byre/registry/reviews.h"

#include "byre/input_error.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

namespace byre {
namespace {

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
