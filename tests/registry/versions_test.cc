// "byre registry": files, versions, reviews, and a registry of another schema.

#include "registry_fixture.h"

#include "byre/base/binary_file.h"
#include "byre/base/output_file.h"
#include "byre/input_error.h"
#include "byre/registry/blobs.h"
#include "byre/registry/connection.h"
#include "byre/registry/versions.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

namespace byre {
namespace {

using cli::Outcome;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::int64_t kBarn = 1;

class RegistryVersions : public RegistryTest {
 protected:
  // Pushes a small map by the program, as the reviewer. Returns its id.
  std::string push(const std::string& note) const {
    const std::string id = write_small_map(note + ".byre", note);
    EXPECT_EQ(registry("push barn " + note + ".byre", "reviewer").exit_code, 0);
    return id;
  }

  std::string accepted() const {
    return value("SELECT coalesce(max(id), '') FROM byre.version WHERE site = 1 AND state = 'accepted'");
  }
};

TEST_F(RegistryVersions, AreProposedAcceptedAndPulled) {
  const std::string id = write_small_map("barn.byre", "barn");
  const Outcome pushed = registry("push barn barn.byre --note 'mapped by day'", "reviewer");
  EXPECT_EQ(pushed.exit_code, 0) << pushed.errors;
  EXPECT_EQ(pushed.output, "version      " + id + " barn.byre\n");
  EXPECT_EQ(registry("push barn barn.byre", "reviewer").output, "version      " + id + " barn.byre, as before\n");
  const Outcome early = registry("pull barn -o pulled.byre", "robot_barn");
  EXPECT_EQ(early.exit_code, 3);
  EXPECT_THAT(early.errors, HasSubstr("has no accepted version of this site, or the account may not read it"));

  EXPECT_EQ(registry("accept barn " + id + " --reason 'looks right'", "reviewer").output, "accepted     " + id + "\n");
  const json pulled = json::parse(registry("pull barn -o pulled.byre --json", "robot_barn").output);
  EXPECT_EQ(pulled.at("id"), id);
  EXPECT_EQ(pulled.at("bytes_received"), read("barn.byre").size());
  EXPECT_EQ(read("pulled.byre"), read("barn.byre"));
  EXPECT_THAT(registry("pull barn -o pulled.byre", "robot_barn").output,
              HasSubstr("written      pulled.byre, as before"));

  const Outcome history = registry("history barn", "reviewer");
  EXPECT_THAT(history.output, testing::MatchesRegex("20[-0-9:TZ]+ accepted " + id +
                                                    " by reviewer: looks right\n20[-0-9:TZ]+ "
                                                    "proposed " +
                                                    id + " by reviewer: mapped by day\n"));
  EXPECT_THAT(registry("list barn", "reviewer").output,
              AllOf(StartsWith("accepted     " + id), HasSubstr("mapped by day")));
  EXPECT_THAT(registry("list", "robot_barn").output, testing::StrEq("barn: accepted " + id + "\n"));
  const json shown = json::parse(registry("show barn " + id + " --json", "reviewer").output);
  EXPECT_EQ(shown.at("note"), "mapped by day");
  EXPECT_EQ(shown.at("events").size(), 2u);
}

TEST_F(RegistryVersions, OfManyChunksAreTheSameBytes) {
  Connection reviewer = connect("reviewer");
  const std::vector<std::byte> map = small_map("large", 3 << 20);
  write("large.byre", std::string(reinterpret_cast<const char*>(map.data()), map.size()));
  const PushedFile pushed = push_file(reviewer, kBarn, folder_ / "large.byre", "");
  EXPECT_EQ(value("SELECT count(*) FROM byre.chunk"), "4");
  EXPECT_EQ(pull_map(reviewer, kBarn, pushed.id, folder_ / "pulled.byre").received, map.size());
  EXPECT_EQ(read("pulled.byre"), read("large.byre"));
}

TEST_F(RegistryVersions, ContinueAnInterruptedPush) {
  Connection reviewer = connect("reviewer");
  const std::vector<std::byte> map = small_map("large", 3 << 20);
  reviewer.run("INSERT INTO byre.chunk SELECT sha256($1), $1", {std::span(map).first(1 << 20)});
  const std::string first = value("SELECT xmin FROM byre.chunk");
  push_blob(reviewer, map);
  EXPECT_EQ(value("SELECT count(*) FROM byre.chunk"), "4");
  EXPECT_EQ(value("SELECT count(*) FROM byre.chunk WHERE xmin::text = $1", {first}), "1") << "it was not sent again";
}

TEST_F(RegistryVersions, AreTransferredOverABrokenConnection) {
  Connection reviewer = connect("reviewer"), owner = connect();
  const auto cut = [&owner] {
    owner.run("SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity WHERE usename = 'reviewer'");
  };
  write_small_map("barn.byre", "barn");
  cut();
  const PushedFile pushed = push_file(reviewer, kBarn, folder_ / "barn.byre", "");
  EXPECT_TRUE(pushed.is_new);
  cut();
  EXPECT_EQ(pull_map(reviewer, kBarn, pushed.id, folder_ / "pulled.byre").id, pushed.id);
  EXPECT_EQ(read("pulled.byre"), read("barn.byre"));
  cut();
  EXPECT_THROW(site_number(reviewer, "barn"), ConnectionLost) << "other statements are not repeated";
}

TEST_F(RegistryVersions, AreTransferredOnceTheDiskOfTheServerHasSpace) {
  Connection reviewer = connect("reviewer"), owner = connect();
  owner.run_script(
      "CREATE SEQUENCE byre.attempt; GRANT USAGE ON SEQUENCE byre.attempt TO byre_reviewer;"
      "CREATE FUNCTION byre.fill() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
      " IF nextval('byre.attempt') = 1 THEN RAISE EXCEPTION 'disk full' USING ERRCODE = 'disk_full'; END IF;"
      " RETURN NEW; END $$; CREATE TRIGGER fill BEFORE INSERT ON byre.chunk FOR EACH ROW EXECUTE FUNCTION byre.fill()");
  write_small_map("barn.byre", "barn");
  EXPECT_TRUE(push_file(reviewer, kBarn, folder_ / "barn.byre", "").is_new);
  EXPECT_EQ(value("SELECT last_value FROM byre.attempt"), "2");
}

TEST_F(RegistryVersions, AreRejectedAndRolledBack) {
  const std::string first = push("first"), second = push("second"), third = push("third");
  EXPECT_EQ(registry("accept barn " + first, "reviewer").exit_code, 0);
  EXPECT_EQ(registry("accept barn " + second, "reviewer").exit_code, 0);
  EXPECT_EQ(registry("reject barn " + third + " --reason 'no gate'", "reviewer").output,
            "rejected     " + third + "\n");
  EXPECT_EQ(registry("accept barn " + third, "reviewer").exit_code, 3);
  EXPECT_EQ(accepted(), second);
  EXPECT_EQ(registry("rollback barn --reason lost", "reviewer").output, "accepted     " + first + "\n");
  EXPECT_EQ(accepted(), first);
  const Outcome none = registry("rollback barn", "reviewer");
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.errors, HasSubstr("there is no earlier accepted version (byre registry history SITE shows"));
  EXPECT_EQ(registry("rollback barn --version " + second, "reviewer").exit_code, 0);
  EXPECT_EQ(accepted(), second);
  EXPECT_EQ(registry("rollback barn --version " + third, "reviewer").exit_code, 3) << "it was never accepted";
}

TEST_F(RegistryVersions, MadeOfAnotherThanTheAcceptedOneAreNotAccepted) {
  Connection reviewer = connect("reviewer");
  const std::string first = push("first"), second = push("second");
  const std::vector<std::byte> child = small_map("child");
  const std::string id = to_text(map_id(child, ""));
  add_version(reviewer, kBarn, id, push_blob(reviewer, child), {first}, "");
  registry("accept barn " + second, "reviewer");
  const Outcome refused = registry("accept barn " + id, "reviewer");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.errors, HasSubstr("was not made of " + second + ", which is accepted"));
  registry("accept barn " + first, "reviewer");
  EXPECT_EQ(registry("accept barn " + id, "reviewer").exit_code, 0);
}

TEST_F(RegistryVersions, ContinueAnInterruptedPull) {
  constexpr std::size_t kChunk = 1 << 20;
  const std::vector<std::byte> map = small_map("large", 3 * kChunk);
  Connection reviewer = connect("reviewer");
  const std::string id = to_text(map_id(map, ""));
  add_version(reviewer, 1, id, push_blob(reviewer, map), {}, "");
  const auto received_after = [&](std::vector<std::byte> interrupted) {
    {
      OutputFile file(folder_ / "robot.byre", FileContent::map);
      file.keep_unpublished(true);
      file.append(interrupted);
    }
    const std::size_t received = pull_map(reviewer, 1, id, folder_ / "robot.byre").received;
    EXPECT_EQ(read_file(folder_ / "robot.byre"), map);
    EXPECT_THAT(read_leftover(folder_ / "robot.byre", FileContent::map), testing::IsEmpty());
    std::filesystem::remove(folder_ / "robot.byre");
    return received;
  };
  std::vector<std::byte> interrupted(map.begin(), map.begin() + kChunk + 1000);
  EXPECT_EQ(received_after(interrupted), map.size() - kChunk);
  interrupted[10] = ~interrupted[10];
  EXPECT_EQ(received_after(interrupted), map.size());
}

TEST_F(RegistryVersions, WithDamagedBytesAreNotPulled) {
  const std::string id = push("barn");
  registry("accept barn " + id, "reviewer");
  // By an administrator who removes the rules first.
  connect().run_script(
      "ALTER TABLE byre.chunk DISABLE TRIGGER ALL; ALTER TABLE byre.chunk DROP CONSTRAINT chunk_hash;"
      "UPDATE byre.chunk SET data = set_byte(data, 200, get_byte(data, 200) # 1)");
  write_small_map("robot.byre", "what the robot has");
  const std::string before = read("robot.byre");
  const Outcome outcome = registry("pull barn -o robot.byre", "robot_barn");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("is damaged: chunk 1 of a file does not have its SHA-256"));
  EXPECT_EQ(read("robot.byre"), before);
}

TEST_F(RegistryVersions, TakeSqlInNamesAsNames) {
  const std::string nasty = "'; DROP SCHEMA byre CASCADE; --\"$$";
  const std::string quoted = "\"'; DROP SCHEMA byre CASCADE; --\\\"\\$\\$\"";
  EXPECT_EQ(registry("init " + quoted).exit_code, 0);
  EXPECT_EQ(value("SELECT name FROM byre.site ORDER BY id DESC LIMIT 1"), nasty);
  write_small_map("barn.byre", "barn");
  const Outcome pushed = registry("push " + quoted + " barn.byre --note " + quoted, "reviewer");
  EXPECT_EQ(pushed.exit_code, 0) << pushed.errors;
  EXPECT_EQ(registry("accept " + quoted + " \"x' OR '1'='1\" --reason " + quoted, "reviewer").exit_code, 3);
  EXPECT_EQ(registry("admit " + quoted + " robot --site " + quoted).exit_code, 0);
  EXPECT_EQ(value("SELECT account FROM byre.robot ORDER BY site DESC LIMIT 1"), nasty);
  EXPECT_EQ(value("SELECT count(*) FROM byre.version WHERE note = $1", {nasty}), "1");
  EXPECT_EQ(connect().run("SELECT FROM byre.site").size(), 3);
}

TEST_F(RegistryVersions, AreNotReadByAnOldClient) {
  connect().run("INSERT INTO byre.schema_version VALUES ($1, $1)", {kRegistrySchema + 1});
  for (const char* const arguments : {"list", "pull barn -o a.byre", "init", "migrate"}) {
    const Outcome outcome = registry(arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors,
                HasSubstr(fmt::format("has schema {}, and this byre is made for schema {} (install a newer "
                                      "byre)",
                                      kRegistrySchema + 1, kRegistrySchema)));
  }
  connect().run("UPDATE byre.schema_version SET oldest_client = $1", {kRegistrySchema});
  EXPECT_EQ(registry("list").exit_code, 0) << "a newer schema that admits this client";
}

class RegistryOfAnOldSchema : public RegistryVersions, public testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(AllWithTables, RegistryOfAnOldSchema, testing::Values(1, 2, 3, 4),
                         testing::PrintToStringParamName());

TEST_P(RegistryOfAnOldSchema, KeepsItsContentWhenItIsUpdated) {
  const std::string name = database_ + "_old";
  connect().run_script("CREATE DATABASE " + name + " STRATEGY file_copy");
  const std::string old = RegistryServer::shared().uri(name);
  Connection owner(old);
  const std::string at = " --registry '" + old + "'";
  EXPECT_THAT(run("registry list" + at).errors, HasSubstr("is no registry of maps"));
  EXPECT_EQ(run("registry migrate" + at).exit_code, 3);
  for (int schema = 1; schema <= GetParam(); ++schema) {
    std::ifstream file(fmt::format(BYRE_REGISTRY_SCHEMA "/{}.sql", schema));
    owner.run_script({std::istreambuf_iterator<char>(file), {}});
    owner.run("INSERT INTO byre.schema_version VALUES ($1, 1)", {schema});
  }
  owner.run("INSERT INTO byre.site (name) VALUES ('barn')");
  EXPECT_THAT(run("registry list" + at).errors,
              HasSubstr(fmt::format("needs schema {} (update it with byre registry migrate)", kRegistrySchema)));
  const std::vector<std::byte> map = small_map("barn"), session = small_session("evening", "0123456789abcdef");
  const std::string id = to_text(map_id(map, ""));
  add_version(owner, kBarn, id, push_blob(owner, map), {}, "by day");
  add_session(owner, kBarn, to_text(map_id(session, "")), push_blob(owner, session), "0123456789abcdef", "evening");

  EXPECT_THAT(run("registry migrate" + at).output,
              StartsWith(fmt::format("schema       {} -> {} in ", GetParam(), kRegistrySchema)));
  EXPECT_EQ(run("registry accept barn " + id + at).exit_code, 0);
  EXPECT_EQ(run("registry pull barn -o barn.byre" + at).exit_code, 0);
  EXPECT_EQ(to_text(map_id(folder_ / "barn.byre")), id);
  EXPECT_EQ(owner.run("SELECT FROM byre.session WHERE state = 'open'").size(), 1);
  EXPECT_EQ(owner.run("SELECT FROM byre.job WHERE state = 'waiting'").size(), 1) << "the session waits for an update";
  write("plan.pgm", "P5\n2 1\n255\n\xff\x01");
  write("plan.yaml", "image: plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
  EXPECT_EQ(run("registry push barn --plan plan.yaml" + at).output, "plan         plan 1 plan.yaml\n");
  owner = connect();
  connect().run_script("DROP DATABASE " + name + " WITH (FORCE)");
}

TEST_F(RegistryVersions, AreInABackupWithThePlans) {
  const std::string id = push("barn");
  registry("accept barn " + id, "reviewer");
  for (const char* const grey : {"\xff\x01", "\x01\xff"}) {
    write("plan.pgm", std::string("P5\n2 1\n255\n") + grey);
    write("plan.yaml", "image: plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
    EXPECT_EQ(registry("push barn --plan plan.yaml", "reviewer").exit_code, 0);
  }
  const std::string name = database_ + "_restored";
  connect().run_script("CREATE DATABASE " + name + " STRATEGY file_copy");
  const std::string restored = RegistryServer::shared().uri(name);
  const std::string command = "pg_dump --format=custom '" + uri() + "' | pg_restore --exit-on-error --dbname='" +
                              restored + "' >'" + (folder_ / "restore.log").string() + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << read("restore.log");
  const std::string robot = " --registry '" + RegistryServer::shared().uri(name, "robot_barn") + "'";
  EXPECT_EQ(run("registry pull barn -o restored.byre --plan plans" + robot).exit_code, 0);
  EXPECT_EQ(read("restored.byre"), read("barn.byre"));
  EXPECT_EQ(read("plans/plan.pgm"), read("plan.pgm"));
  EXPECT_EQ(run("registry pull barn --plan plans --version 1" + robot).exit_code, 0);
  EXPECT_NE(read("plans/plan.pgm"), read("plan.pgm"));
  EXPECT_EQ(run("registry push barn --plan plan.yaml --registry '" + restored + "'").output,
            "plan         plan 2 plan.yaml, as before\n");
  connect().run_script("DROP DATABASE " + name + " WITH (FORCE)");
}

TEST_F(RegistryVersions, AreCountedForPrometheus) {
  const std::string id = push("barn");
  registry("accept barn " + id, "reviewer");
  push("second");
  connect("robot_barn").run("UPDATE byre.robot SET seen_at = to_timestamp(1700000000), runs = $1, waiting = 2", {id});
  connect().run("UPDATE byre.site SET name = $1 WHERE name = 'annex'", {"the \"new\" \\ annex"});
  const Outcome outcome = registry("metrics", "reviewer");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  for (const std::string& line : std::vector<std::string>{
           "# TYPE byre_registry_versions gauge", "byre_registry_versions{site=\"barn\",state=\"accepted\"} 1",
           "byre_registry_versions{site=\"barn\",state=\"proposed\"} 1",
           "byre_registry_versions{site=\"the \\\"new\\\" \\\\ annex\",state=\"accepted\"} 0",
           "byre_registry_jobs{site=\"barn\",state=\"failed\"} 0", "byre_registry_open_sessions{site=\"barn\"} 0",
           "byre_registry_robot_seen_timestamp_seconds{site=\"barn\",robot=\"robot_barn\"} 1700000000",
           "byre_registry_robot_sessions_waiting{site=\"barn\",robot=\"robot_barn\"} 2",
           "byre_registry_robot_runs_accepted{site=\"barn\",robot=\"robot_barn\",version=\"" + id +
               "\",refused=\"\"} 1"}) {
    EXPECT_THAT(outcome.output, HasSubstr(line + "\n"));
  }
  EXPECT_THAT(registry("list barn", "reviewer").output,
              HasSubstr("robot        robot_barn, seen 2023-11-14T22:13:20Z, runs " + id + ", 2 sessions wait\n"));
}

TEST_F(RegistryVersions, AreWatched) {
  const std::string first = push("first"), second = push("second");
  registry("accept barn " + first, "reviewer");
  const pid_t process = start({"registry", "watch", "barn", "--once", "--registry", uri("robot_barn")});
  EXPECT_TRUE(appears(first + "\n", "stdout.txt"));
  Connection reviewer = connect("reviewer");  // a run of the program would replace stdout.txt
  reviewer.run("SELECT byre.accept($1, $2, '')", {kBarn, second});
  EXPECT_EQ(exit_code_of(process), 0);
  EXPECT_EQ(read("stdout.txt"), first + "\n" + second + "\n");
}

TEST_F(RegistryVersions, OfUnknownSitesAreExplained) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"list bran", "has no site 'bran', or the account may not see it (did you mean 'barn'?)"},
      {"show barn 0123456789abcdef", "has no version 0123456789abcdef of this site"},
      {"pull barn --version 0123456789abcdef -o a.byre", "has no version 0123456789abcdef, or"},
      {"push barn absent.byre", "absent.byre: "},
      {"admit robot_2 robot", "a robot has a site"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = registry(arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, HasSubstr(message));
  }
  const Outcome unreachable = run("registry list --registry 'host=/nowhere dbname=byre'");
  EXPECT_EQ(unreachable.exit_code, 1);
  EXPECT_THAT(unreachable.errors,
              AllOf(StartsWith("byre: error: registry /nowhere/byre: "), HasSubstr("check --registry")));
}

}  // namespace
}  // namespace byre
