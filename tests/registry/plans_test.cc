// Floor plans of a registry: versions, access, files.

#include "registry_fixture.h"

#include "byre/base/binary_file.h"
#include "byre/base/output_file.h"
#include "byre/floor_plan.h"
#include "byre/input_error.h"
#include "byre/registry/blobs.h"

#include <chrono>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

namespace fs = std::filesystem;
using cli::Outcome;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr std::int64_t kBarn = 1;

class RegistryPlans : public RegistryTest {
 protected:
  // Writes NAME.yaml and NAME.pgm of pixels with this grey value.
  void write_plan(const std::string& name, char grey, int width = 3, int height = 2) const {
    write(name + ".pgm",
          fmt::format("P5\n{} {}\n255\n", width, height) + std::string(static_cast<std::size_t>(width * height), grey));
    write(name + ".yaml", "image: " + name + ".pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
  }

  Outcome push(const std::string& arguments) const { return registry("push barn " + arguments, "reviewer"); }

  std::int64_t rows(const std::string& account, const std::string& table) const {
    return connect(account).run(("SELECT count(*) FROM byre." + table).c_str()).number(0, 0);
  }
};

TEST_F(RegistryPlans, ArePushedAndPulled) {
  write_plan("plan", '\xff');
  const Outcome pushed = push("--plan plan.yaml --name ground --note 'by the architect'");
  EXPECT_EQ(pushed.output, "plan         ground 1 plan.yaml\n") << pushed.errors;
  EXPECT_EQ(push("--plan plan.yaml --name ground").output, "plan         ground 1 plan.yaml, as before\n");
  EXPECT_EQ(value("SELECT count(*) FROM byre.plan"), "1");
  const Outcome pulled = registry("pull barn --plan plans", "robot_barn");
  EXPECT_THAT(pulled.output, StartsWith("plan         ground 1\nwritten      plans/plan.yaml: ")) << pulled.errors;
  EXPECT_EQ(read("plans/plan.yaml"), read("plan.yaml"));
  EXPECT_EQ(read("plans/plan.pgm"), read("plan.pgm"));
  EXPECT_THAT(registry("pull barn --plan plans", "robot_barn").output,
              HasSubstr("written      plans/plan.yaml, as before"));

  EXPECT_THAT(registry("list barn", "reviewer").output,
              testing::ContainsRegex("plan         ground 1 plan.yaml, by reviewer 20[-0-9:TZ]+: by the architect\n"));
  EXPECT_THAT(registry("history barn", "reviewer").output, HasSubstr("plan ground 1 by reviewer: by the architect\n"));
  EXPECT_EQ(json::parse(registry("show barn --plan --json", "reviewer").output).at(0).at("bytes"),
            read("plan.yaml").size() + read("plan.pgm").size());
}

TEST_F(RegistryPlans, KeepEarlierOnesAndTheNewestIsCurrent) {
  for (const char grey : {'\xff', '\x01', '\xff'}) {  // the third as the first
    write_plan("plan", grey);
    EXPECT_EQ(push("--plan plan.yaml").exit_code, 0);
  }
  EXPECT_EQ(value("SELECT string_agg(number || ' ' || name, ', ' ORDER BY number) FROM byre.plan"),
            "1 plan, 2 plan, 3 plan");
  EXPECT_THAT(registry("list barn", "reviewer").output, HasSubstr("plan 3 plan.yaml"));
  EXPECT_THAT(registry("show barn --plan", "reviewer").output,
              testing::MatchesRegex("plan +plan 3 plan.yaml with plan.pgm, [^\n]*\nplan +plan 2 [^\n]*\nplan +plan 1 "
                                    "[^\n]*\n"));
  EXPECT_EQ(registry("pull barn --plan plans", "reviewer").exit_code, 0);
  EXPECT_EQ(read("plans/plan.pgm"), read("plan.pgm"));
  EXPECT_EQ(registry("pull barn --plan plans --version 2", "reviewer").exit_code, 0);
  EXPECT_THAT(read("plans/plan.pgm"), testing::EndsWith("\x01\x01\x01\x01\x01\x01"));
}

TEST_F(RegistryPlans, OfSeveralFloorsHaveNames) {
  write_plan("ground", '\xff');
  write_plan("upper", '\x01');
  EXPECT_EQ(push("--plan ground.yaml").exit_code, 0);
  EXPECT_EQ(push("--plan upper.yaml").exit_code, 0);
  EXPECT_THAT(registry("pull barn --plan plans", "robot_barn").errors,
              HasSubstr("has several plans of this site: ground, upper (choose one with --name)"));
  EXPECT_EQ(registry("pull barn --plan plans --name upper", "robot_barn").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "plans/upper.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / "plans/ground.yaml"));
  EXPECT_THAT(push("--plan upper.yaml --name attic").errors,
              HasSubstr("the plan upper of the site has the file name upper.yaml too (rename the file: maps name"));
  EXPECT_EQ(value("SELECT count(*) FROM byre.plan"), "2");
}

TEST_F(RegistryPlans, MayBeAnImageWithAWorldFile) {
  write("plan.pgm", "P5\n2 1\n255\n\xff\x01");
  write("plan.wld", "0.05\n0\n0\n-0.05\n7\n8\n");
  EXPECT_EQ(push("--plan plan.pgm").output, "plan         plan 1 plan.pgm\n");
  Connection robot = connect("robot_barn");
  const PulledPlan pulled = pull_plan(robot, kBarn, find_plan(robot, kBarn, {}, {}), folder_ / "plans");
  EXPECT_EQ(read_floor_plan(pulled.path).top_left_in_plan, Eigen::Vector2d(7.0, 8.0));
  write("plans/plan.pmw", "0.05\n0\n0\n-0.05\n9\n9\n");  // preferred by readers
  EXPECT_THAT(registry("pull barn --plan plans", "robot_barn").errors,
              HasSubstr("plan.pmw: is read with plan.pgm instead of plan.wld (remove it"));
}

TEST_F(RegistryPlans, ThatCannotBeReadAreRefused) {
  write_plan("plan", '\xff');
  write("far.yaml", "image: ./plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
  write("absent_image.yaml", "image: no.png\nresolution: 0.05\norigin: [0, 0, 0]\n");
  write("text.yaml", "resolution: 0.05\n");
  write("damaged.png", "\x89PNG\r\n");
  write_small_map("barn.byre", "barn");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"far.yaml", "image: is in another folder: ./plan.pgm (put the image beside this file, and give its name alone"},
      {"absent_image.yaml", "no.png: cannot be read as the image of a floor plan (check that it exists"},
      {"text.yaml", "text.yaml: image: is missing"},
      {"damaged.png", "damaged.png: cannot be read as the image"},
      {"barn.byre", "barn.byre: cannot be read as the image"},
      {"plan.pgm", "has no world file in its folder"},
      {"plan.yaml --name '" + std::string(201, 'x') + "'", "--name: has control characters, or more than 200 bytes"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = push("--plan " + arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, HasSubstr(message));
  }
  EXPECT_EQ(value("SELECT count(*) FROM byre.plan"), "0");
  EXPECT_EQ(push("").exit_code, 2);
  EXPECT_EQ(registry("pull barn", "reviewer").exit_code, 2);
  EXPECT_EQ(registry("show barn", "reviewer").exit_code, 2);
  for (const char* const arguments : {"pull barn --plan plans --name ground", "show barn --plan --name ground"}) {
    const Outcome outcome = registry(arguments, "reviewer");
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(outcome.errors, HasSubstr("has no plan 'ground' of this site, or the account may not read it"));
  }
}

TEST_F(RegistryPlans, AreReadByRobotsOfTheSiteAlone) {
  write_plan("plan", '\xff');
  EXPECT_EQ(push("--plan plan.yaml").exit_code, 0);
  for (const char* const table : {"plan", "site", "robot"}) EXPECT_EQ(rows("robot_barn", table), 1) << table;
  for (const char* const table : {"blob", "blob_chunk", "chunk"}) EXPECT_EQ(rows("robot_barn", table), 2) << table;
  for (const char* const table : {"plan", "blob", "blob_chunk", "chunk"}) {
    EXPECT_EQ(rows("robot_annex", table), 0) << table;
  }
  Connection owner = connect(), stranger = connect("robot_annex");
  EXPECT_THAT(current_plans(stranger, kBarn), IsEmpty());
  const RegistryPlan plan = find_plan(owner, kBarn, {}, {});
  EXPECT_THROW(pull_plan(stranger, kBarn, plan, folder_ / "plans"), InputError);
  EXPECT_THROW(pull_blob(stranger, owner.bytes("SELECT blob FROM byre.plan", {}).value(), "", folder_ / "a.yaml",
                         FileContent::yaml),
               InputError);
  EXPECT_FALSE(fs::exists(folder_ / "a.yaml"));
  EXPECT_THAT(refusal("outsider", "SELECT FROM byre.plan"), HasSubstr("permission denied"));
}

TEST_F(RegistryPlans, AreAddedByReviewersAloneAndNeverChanged) {
  write_plan("plan", '\xff');
  EXPECT_EQ(push("--plan plan.yaml").exit_code, 0);
  for (const std::string account : {"robot_barn", "worker"}) {
    const Outcome outcome = registry("push barn --plan plan.yaml --name mine", account);
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(outcome.errors, HasSubstr("permission denied for table plan for the account " + account));
  }
  const char* const add =
      "INSERT INTO byre.plan (site, name, file, blob, other_file, other_blob) SELECT site, $1, $2, blob, other_file, "
      "other_blob FROM byre.plan";
  EXPECT_THAT(refusal("reviewer", "INSERT INTO byre.plan (site, name, number) VALUES (1, 'x', 7)"),
              HasSubstr("denied"));
  EXPECT_THAT(refusal("reviewer", "INSERT INTO byre.plan (site, added_by) VALUES (1, 'ann')"), HasSubstr("denied"));
  for (const char* const file : {"../plan.yaml", "/etc/plan.yaml", "..", ".plan", "", "a\nb", "plan.pgm"}) {
    EXPECT_THAT(refusal("reviewer", add, {"upper", file}), HasSubstr("plan_files")) << file;
  }
  EXPECT_THAT(refusal("reviewer",
                      "INSERT INTO byre.plan (site, name, file, blob, other_file, other_blob) VALUES (1, "
                      "'x', 'x.png', '\\x00', 'x.pgw', '\\x00')"),
              HasSubstr("foreign key"));
  for (const char* const statement :
       {"UPDATE byre.plan SET name = 'x'", "DELETE FROM byre.plan", "TRUNCATE byre.plan"}) {
    for (const char* const account : {"robot_barn", "reviewer", "worker"}) {
      EXPECT_THAT(refusal(account, statement), HasSubstr("permission denied"));
    }
    EXPECT_THAT(refusal("", statement), HasSubstr("neither changed nor removed"));
  }
  EXPECT_EQ(value("SELECT count(*) FROM byre.event WHERE kind = 'plan'"), "1");
}

TEST_F(RegistryPlans, TakeSqlInNamesAsNames) {
  const std::string nasty = "'; DROP SCHEMA byre CASCADE; --\"";
  const std::string quoted = "\"'; DROP SCHEMA byre CASCADE; --\\\"\"";
  write_plan("plan", '\xff');
  write(nasty + ".yaml", read("plan.yaml"));
  EXPECT_EQ(push("--plan " + quoted + ".yaml --note " + quoted).exit_code, 0);
  EXPECT_EQ(value("SELECT name || file || note FROM byre.plan"), nasty + nasty + ".yaml" + nasty);
  EXPECT_EQ(registry("pull barn --plan plans --name " + quoted, "robot_barn").exit_code, 0);
  EXPECT_EQ(read("plans/" + nasty + ".yaml"), read(nasty + ".yaml"));
  EXPECT_EQ(registry("pull barn --plan plans --name \"x' OR '1'='1\"", "robot_barn").exit_code, 3);
  EXPECT_EQ(registry("pull barn --plan plans --version \"1' OR '1'='1\"", "robot_barn").exit_code, 3);
}

TEST_F(RegistryPlans, WithDamagedBytesAreNotPulled) {
  write_plan("plan", '\xff');
  EXPECT_EQ(push("--plan plan.yaml").exit_code, 0);
  EXPECT_EQ(registry("pull barn --plan plans", "robot_barn").exit_code, 0);
  // By an administrator who removes the rules first.
  connect().run_script(
      "ALTER TABLE byre.chunk DISABLE TRIGGER ALL; ALTER TABLE byre.chunk DROP CONSTRAINT chunk_hash;"
      "UPDATE byre.chunk SET data = set_byte(data, 12, get_byte(data, 12) # 1)");
  fs::remove(folder_ / "plans/plan.yaml");
  write("plans/plan.pgm", "P5\n2 1\n255\n\xff\x01");
  const Outcome outcome = registry("pull barn --plan plans", "robot_barn");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("is damaged: chunk 1 of a file does not have its SHA-256"));
  EXPECT_FALSE(fs::exists(folder_ / "plans/plan.yaml"));
  EXPECT_EQ(read("plans/plan.pgm"), "P5\n2 1\n255\n\xff\x01");
}

TEST_F(RegistryPlans, ContinueAnInterruptedPull) {
  write_plan("plan", '\xff', 2000, 1200);
  std::mt19937 random(3);
  std::string image = read("plan.pgm");
  for (std::size_t i = 20; i < image.size(); ++i) image[i] = static_cast<char>(random());
  write("plan.pgm", image);
  EXPECT_EQ(push("--plan plan.yaml").exit_code, 0);
  constexpr std::size_t kChunk = 1 << 20;
  fs::create_directories(folder_ / "plans");
  {
    OutputFile file(folder_ / "plans/plan.pgm", FileContent::pgm);
    file.keep_unpublished(true);
    file.append(std::as_bytes(std::span(image).first(kChunk + 1000)));
  }
  Connection robot = connect("robot_barn");
  const PulledPlan pulled = pull_plan(robot, kBarn, find_plan(robot, kBarn, {}, {}), folder_ / "plans");
  EXPECT_EQ(pulled.received, image.size() - kChunk + read("plan.yaml").size());
  EXPECT_EQ(read("plans/plan.pgm"), image);
}

TEST_F(RegistryPlans, ArePushedAndPulledOverABrokenConnection) {
  Connection reviewer = connect("reviewer"), owner = connect();
  const auto cut = [&owner] {
    owner.run("SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity WHERE usename = 'reviewer'");
  };
  write_plan("plan", '\xff');
  cut();
  EXPECT_TRUE(push_plan(reviewer, kBarn, folder_ / "plan.yaml", {}, "").is_new);
  cut();
  const RegistryPlan plan = find_plan(reviewer, kBarn, {}, {});
  cut();
  pull_plan(reviewer, kBarn, plan, folder_ / "plans");
  EXPECT_EQ(read("plans/plan.pgm"), read("plan.pgm"));
}

TEST_F(RegistryPlans, OfTwoReviewersAtOnceAreNumberedInOrder) {
  write_plan("plan", '\x01');
  Connection first = connect("reviewer");
  push_plan(first, 2, folder_ / "plan.yaml", {}, "");  // the files are stored
  write_plan("plan", '\xff');
  push_plan(first, 2, folder_ / "plan.yaml", {}, "");
  Transaction transaction(first);
  push_plan(first, kBarn, folder_ / "plan.yaml", {}, "");
  write_plan("plan", '\x01');
  const pid_t process =
      start({"registry", "push", "barn", "--plan", (folder_ / "plan.yaml").string(), "--registry", uri("reviewer")});
  const auto is_waiting = [this] {
    return value("SELECT count(*) FROM pg_stat_activity WHERE wait_event_type = 'Lock' AND query LIKE '%byre.plan%'") !=
           "0";
  };
  for (int i = 0; i < 3000 && !is_waiting(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  transaction.commit();
  EXPECT_EQ(exit_code_of(process), 0) << read("stderr.txt");
  EXPECT_THAT(read("stdout.txt"), StartsWith("plan         plan 2 "));
}

}  // namespace
}  // namespace byre
