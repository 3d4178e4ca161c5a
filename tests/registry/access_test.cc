// Rules of access, which the server enforces: what each role may read and write.

#include "registry_fixture.h"

#include "byre/input_error.h"
#include "byre/registry/blobs.h"
#include "byre/registry/versions.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// Number of the site "barn"; "annex" is number 2.
constexpr std::int64_t kBarn = 1, kAnnex = 2;

class RegistryAccess : public RegistryTest {
 protected:
  void SetUp() override {
    RegistryTest::SetUp();
    if (IsSkipped()) return;
    Connection reviewer = connect("reviewer");
    for (const auto& [site, note] :
         {std::pair(kBarn, "accepted"), std::pair(kBarn, "proposed"), std::pair(kAnnex, "annex")}) {
      const std::vector<std::byte> map = small_map(note);
      ids_.push_back(to_text(map_id(map, note)));
      blobs_.push_back(push_blob(reviewer, map));
      add_version(reviewer, site, ids_.back(), blobs_.back(), {}, note);
    }
    reviewer.run("SELECT byre.accept($1, $2, '')", {kBarn, ids_[0]});
    reviewer.run("SELECT byre.accept($1, $2, '')", {kAnnex, ids_[2]});
  }

  // Number of rows that an account reads.
  std::int64_t rows(const std::string& account, const std::string& table) const {
    return connect(account).run(("SELECT count(*) FROM byre." + table).c_str()).number(0, 0);
  }

  std::vector<std::string> ids_;               // accepted and proposed version of the barn, accepted one of the annex
  std::vector<std::vector<std::byte>> blobs_;  // their files
};

TEST_F(RegistryAccess, ARobotReadsTheAcceptedVersionOfItsSite) {
  for (const char* const table : {"site", "robot", "version", "blob", "blob_chunk", "chunk"}) {
    EXPECT_EQ(rows("robot_barn", table), 1) << table;
  }
  for (const char* const table : {"session", "event", "job", "version_session"}) {
    EXPECT_EQ(rows("robot_barn", table), 0) << table;
  }
  Connection robot = connect("robot_barn");
  EXPECT_EQ(accepted_version(robot, kBarn), ids_[0]);
  EXPECT_EQ(pull_map(robot, kBarn, {}, folder_ / "barn.byre").id, ids_[0]);
  EXPECT_EQ(to_text(map_id(folder_ / "barn.byre")), ids_[0]);
}

TEST_F(RegistryAccess, ARobotReadsNeitherProposedVersionsNorOtherSites) {
  Connection robot = connect("robot_barn");
  EXPECT_THROW(pull_map(robot, kBarn, ids_[1], folder_ / "a.byre"), InputError);
  EXPECT_THROW(pull_map(robot, kAnnex, ids_[2], folder_ / "a.byre"), InputError);
  for (const std::size_t other : {1, 2}) {
    EXPECT_THROW(pull_blob(robot, blobs_[other], ids_[other], folder_ / "a.byre"), InputError);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.byre"));
  EXPECT_THROW(site_number(robot, "annex"), InputError);
}

TEST_F(RegistryAccess, ARobotAddsSessionsOfItsSite) {
  Connection robot = connect("robot_barn");
  const std::vector<std::byte> session = small_session("evening", ids_[0]);
  const std::string id = to_text(map_id(session, ""));
  const std::vector<std::byte> blob = push_blob(robot, session);
  EXPECT_TRUE(add_session(robot, kBarn, id, blob, ids_[0], "evening"));
  EXPECT_FALSE(add_session(robot, kBarn, id, blob, ids_[0], "evening")) << "it is there";
  EXPECT_EQ(value("SELECT added_by FROM byre.session"), "robot_barn");
  EXPECT_THROW(add_session(robot, kAnnex, id, blob, ids_[0], "evening"), InputError);
  EXPECT_EQ(value("SELECT count(*) FROM byre.session"), "1");
  EXPECT_EQ(rows("robot_annex", "session"), 0);
}

TEST_F(RegistryAccess, ARobotChangesNothing) {
  const std::vector<std::pair<const char*, std::vector<Parameter>>> statements = {
      {"INSERT INTO byre.version (site, id, blob) VALUES ($1, $2, $3)", {kBarn, ids_[2], blobs_[2]}},
      {"UPDATE byre.version SET state = 'retired'", {}},
      {"SELECT byre.accept($1, $2, '')", {kBarn, ids_[1]}},
      {"SELECT byre.rollback($1, NULL, '')", {kBarn}},
      {"UPDATE byre.session SET state = 'closed'", {}},
      {"DELETE FROM byre.session", {}},
      {"UPDATE byre.chunk SET data = ''", {}},
      {"INSERT INTO byre.blob VALUES ('', 0)", {}},
      {"INSERT INTO byre.site (name) VALUES ('mine')", {}},
      {"UPDATE byre.robot SET site = 2", {}},
      {"INSERT INTO byre.event (site, actor, kind, subject) VALUES (1, 'reviewer', 'accepted', '')", {}},
      {"INSERT INTO byre.job (site, kind) VALUES (1, 'update')", {}},
      {"SELECT byre.take_job('me', '1 s', 1)", {}},
      {"SELECT byre.admit('robot_barn', 'reviewer', NULL)", {}},
      {"INSERT INTO byre.session (site, id, blob, ran_on, name, added_by) VALUES (1, '', '', '', '', 'robot_2')", {}},
  };
  for (const auto& [statement, parameters] : statements) {
    EXPECT_THAT(refusal("robot_barn", statement, parameters), HasSubstr("permission denied")) << statement;
  }
  EXPECT_EQ(value("SELECT string_agg(state, ' ' ORDER BY state) FROM byre.version"), "accepted accepted proposed");
}

TEST_F(RegistryAccess, AReviewerChangesStatesOnly) {
  EXPECT_THAT(refusal("reviewer", "UPDATE byre.version SET blob = $1", {blobs_[2]}), HasSubstr("denied"));
  EXPECT_THAT(refusal("reviewer", "DELETE FROM byre.version"), HasSubstr("denied"));
  EXPECT_THAT(refusal("reviewer", "UPDATE byre.chunk SET data = ''"), HasSubstr("denied"));
  EXPECT_THAT(refusal("reviewer", "INSERT INTO byre.version (site, id, blob, state) VALUES (1, '', '', 'accepted')"),
              HasSubstr("denied"));
  EXPECT_THAT(refusal("reviewer", "UPDATE byre.version SET state = 'proposed'"), HasSubstr("cannot become proposed"));
  EXPECT_THAT(refusal("reviewer", "UPDATE byre.version SET state = 'retired' WHERE id = $1", {ids_[1]}), IsEmpty());
  EXPECT_THAT(refusal("reviewer", "UPDATE byre.version SET state = 'accepted' WHERE id = $1", {ids_[1]}),
              HasSubstr("cannot become accepted"))
      << "it was rejected";
  EXPECT_EQ(value("SELECT actor FROM byre.event WHERE kind = 'retired'"), "reviewer");
}

TEST_F(RegistryAccess, AWorkerAcceptsNothing) {
  EXPECT_THAT(refusal("worker", "UPDATE byre.version SET state = 'accepted' WHERE id = $1", {ids_[1]}),
              HasSubstr("row-level security"));
  EXPECT_THAT(refusal("worker", "SELECT byre.accept($1, $2, '')", {kBarn, ids_[1]}), HasSubstr("denied"));
  EXPECT_EQ(connect("worker").run("UPDATE byre.version SET state = 'retired' WHERE state = 'accepted'").changed(), 0);
  EXPECT_THAT(refusal("worker", "UPDATE byre.chunk SET data = ''"), HasSubstr("denied"));
  EXPECT_THAT(refusal("worker", "UPDATE byre.job SET kind = 'merge'"), HasSubstr("denied"));
}

TEST_F(RegistryAccess, TheOwnerRewritesNoVersionNoFileAndNoEvent) {
  const std::vector<const char*> statements = {
      "UPDATE byre.chunk SET data = 'x'",
      "DELETE FROM byre.chunk",
      "TRUNCATE byre.event",
      "UPDATE byre.blob SET size = 1",
      "UPDATE byre.blob_chunk SET number = 7",
      "UPDATE byre.event SET actor = 'robot_2'",
      "UPDATE byre.version SET blob = (SELECT max(hash::text)::bytea FROM byre.blob)",
      "UPDATE byre.version SET note = 'new'",
      "DELETE FROM byre.version",
  };
  for (const char* const statement : statements) {
    EXPECT_THAT(refusal("", statement), testing::AnyOf(HasSubstr("neither changed nor removed"), HasSubstr("changed,")))
        << statement;
  }
}

TEST_F(RegistryAccess, OthersReadNothing) {
  EXPECT_THAT(refusal("outsider", "SELECT FROM byre.site"), HasSubstr("permission denied for schema byre"));
  const cli::Outcome outcome = registry("list", "outsider");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("permission denied for schema byre for the account outsider (use an account"));
}

TEST_F(RegistryAccess, BytesWithAnotherHashAreRefused) {
  const std::vector<std::byte> bytes = small_map("other");
  EXPECT_THAT(refusal("robot_barn", "INSERT INTO byre.chunk VALUES ($1, $2)", {blobs_[0], bytes}),
              HasSubstr("refuses a chunk whose bytes do not have its SHA-256"));
  EXPECT_THAT(refusal("robot_barn", "SELECT byre.add_blob($1)", {blobs_[0]}), HasSubstr("lacks some of its chunks"));
}

TEST_F(RegistryAccess, FilesWithAnotherIdAreRefused) {
  EXPECT_THAT(refusal("reviewer", "INSERT INTO byre.version (site, id, blob) VALUES (1, $1, $2)", {ids_[2], blobs_[1]}),
              HasSubstr("the file has the id " + ids_[1] + ", not " + ids_[2]));
  Connection reviewer = connect("reviewer");
  const std::string text = "no map at all";
  const std::vector<std::byte> blob = push_blob(reviewer, std::as_bytes(std::span(text)));
  EXPECT_THAT(refusal("reviewer", "INSERT INTO byre.version (site, id, blob) VALUES (1, $1, $2)", {ids_[2], blob}),
              HasSubstr("the file of " + ids_[2] + " is no map"));
}

}  // namespace
}  // namespace byre
