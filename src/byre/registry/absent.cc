// Link to a registry in a build without libpq, which cannot be constructed.
#include "byre/input_error.h"
#include "byre/registry/robot_link.h"

namespace byre {

struct RobotLink::Impl {};

RobotLink::RobotLink(const RobotLinkOptions& options) {
  throw InputError("registry.site", "is " + options.site + ", but this build has no PostgreSQL client",
                   "remove the setting, or install libpq-dev and build byre with -DBYRE_WITH_LIBPQ=ON");
}

RobotLink::~RobotLink() = default;

void RobotLink::start() {}

std::filesystem::path RobotLink::last_session() const {
  return {};
}

bool RobotLink::queue_last_session(const std::string&) {
  return false;
}

std::optional<std::filesystem::path> RobotLink::fetched() const {
  return {};
}

void RobotLink::refuse(const std::filesystem::path&, const std::string&) {}

void RobotLink::note_present() {}

RobotLinkState RobotLink::state() const {
  return {};
}

}  // namespace byre
