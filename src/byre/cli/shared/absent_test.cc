#include "byre/cli/shared/absent.h"

#include <sstream>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>

namespace byre::cli {
namespace {

TEST(AbsentCommand, AcceptsAnyArgumentsAndFailsWithReasonAndRemedy) {
  CLI::App app("", "byre");
  CLI::App* const command = app.add_subcommand("simulate", "Render");
  const Action action = declare_absent(*command, "ray tracing", "libembree-dev", "BYRE_WITH_EMBREE");
  app.parse("simulate cowshed -o barn --rate 10");
  std::ostringstream result;
  EXPECT_THAT([&] { action(result); },
              testing::ThrowsMessage<std::runtime_error>(
                  "byre simulate: this build has no ray tracing (install libembree-dev and build byre with "
                  "-DBYRE_WITH_EMBREE=ON)"));
}

}  // namespace
}  // namespace byre::cli
