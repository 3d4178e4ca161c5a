// "byre worker" with maps and sessions of a rendered room.

#include "registry_fixture.h"

#include <csignal>
#include <random>
#include <thread>

#include <gmock/gmock.h>

namespace byre {
namespace {

using cli::Outcome;
using testing::AllOf;
using testing::HasSubstr;

// A registry with a map of half of the recording, accepted, and a session of a mission on all of it.
class RegistryWorker : public RegistryTest {
 protected:
  void SetUp() override {
    RegistryTest::SetUp();
    if (IsSkipped()) return;
    map_room("--frames :12", "room.byre");
    const Outcome mission =
        run_once("run " + cli::rendered_room() + " --map room.byre --save-session evening.session --quiet");
    ASSERT_EQ(mission.exit_code, 0) << mission.errors;
    base_ = to_text(map_id(folder_ / "room.byre"));
    ASSERT_EQ(registry("push barn room.byre", "reviewer").exit_code, 0);
    ASSERT_EQ(registry("accept barn " + base_, "reviewer").exit_code, 0);
    ASSERT_EQ(registry("push barn evening.session", "robot_barn").exit_code, 0);
  }

  std::string base_;
};

TEST_F(RegistryWorker, ProposesTheMapThatUpdateWrites) {
  EXPECT_EQ(run("update room.byre evening.session -o expected.byre --quiet").exit_code, 0);
  const std::string expected = to_text(map_id(folder_ / "expected.byre"));
  const Outcome outcome = worker();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("job 1 done: evening: "));
  EXPECT_EQ(value("SELECT id FROM byre.version WHERE state = 'proposed'"), expected);
  EXPECT_EQ(value("SELECT parents FROM byre.version WHERE state = 'proposed'"), "{" + base_ + "}");
  EXPECT_THAT(registry("show barn " + expected, "reviewer").output,
              AllOf(HasSubstr("made of      " + base_), HasSubstr("evening, ran on " + base_ + ", by robot_barn")));
  EXPECT_EQ(registry("accept barn " + expected, "reviewer").exit_code, 0);
  EXPECT_EQ(value("SELECT state FROM byre.session"), "closed");
  EXPECT_EQ(registry("pull barn -o pulled.byre", "robot_barn").exit_code, 0);
  EXPECT_EQ(read("pulled.byre"), read("expected.byre"));
  EXPECT_EQ(run("validate pulled.byre").exit_code, 0);
}

TEST_F(RegistryWorker, ClosesSessionsWithoutUse) {
  write_small_session("empty.session", "without keyframes", base_);
  EXPECT_EQ(registry("push barn empty.session", "robot_barn").exit_code, 0);
  map_room("--stride 2", "other.byre");
  EXPECT_EQ(registry("push annex other.byre", "reviewer").exit_code, 0);
  EXPECT_EQ(registry("accept annex " + to_text(map_id(folder_ / "other.byre")), "reviewer").exit_code, 0);
  EXPECT_EQ(registry("push annex evening.session", "robot_annex").exit_code, 0);
  EXPECT_EQ(worker().exit_code, 0);
  EXPECT_EQ(value("SELECT name || ': ' || reason FROM byre.session WHERE site = 1 AND state = 'closed'"),
            "empty: contains no keyframes");
  EXPECT_EQ(value("SELECT name || ': ' || reason FROM byre.session WHERE site = 2 AND state = 'closed'"),
            "evening: it ran on another map (" + base_ + ") than this one and the versions it was made of");
  EXPECT_EQ(value("SELECT string_agg(site::text, ' ') FROM byre.version WHERE state = 'proposed'"), "1");
  EXPECT_EQ(value("SELECT message FROM byre.job WHERE site = 2"), "no session fits the map");
}

TEST_F(RegistryWorker, SetsAsideAJobThatFails) {
  EXPECT_EQ(registry("request barn --merge " + base_ + " 0123456789abcdef", "reviewer").exit_code, 0);
  const Outcome outcome = worker("--once --attempts 1");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("job 2 failed: "));
  EXPECT_THAT(registry("list barn", "reviewer").output, HasSubstr("merge, failed, attempt 1: registry"));
}

TEST_F(RegistryWorker, MergesVersionsOrGivesTheReason) {
  write_small_map("empty.byre", "without keyframes");
  EXPECT_EQ(registry("push barn empty.byre", "reviewer").exit_code, 0);
  const std::string empty = to_text(map_id(folder_ / "empty.byre"));
  EXPECT_EQ(registry("request barn --merge " + base_ + " " + empty, "reviewer").exit_code, 0);
  EXPECT_EQ(worker().exit_code, 0);
  EXPECT_THAT(value("SELECT state || ' ' || message FROM byre.job WHERE kind = 'merge'"), HasSubstr("done "));
  EXPECT_EQ(value("SELECT count(*) FROM byre.job WHERE kind = 'merge' AND result IS NULL"), "1");
}

TEST_F(RegistryWorker, ProposesTheMapOfARecording) {
  EXPECT_EQ(registry("request barn --map " + cli::rendered_room(), "reviewer").output, "requested    map\n");
  map_room("", "expected.byre");
  const std::string expected = to_text(map_id(folder_ / "expected.byre"));
  const Outcome outcome = worker("--once --kinds map summarise");
  EXPECT_THAT(outcome.output, HasSubstr("job 2 done: ")) << outcome.errors;
  EXPECT_EQ(value("SELECT id || ' ' || parents::text FROM byre.version WHERE state = 'proposed'"), expected + " {}");
  EXPECT_EQ(value("SELECT state FROM byre.job WHERE kind = 'update'"), "waiting") << "not of these kinds";
  EXPECT_EQ(registry("request barn --map " + cli::rendered_room(), "reviewer").exit_code, 0);
  EXPECT_THAT(worker("--once --kinds map").output, HasSubstr("job 3 done: "));
  EXPECT_EQ(value("SELECT count(*) FROM byre.version"), "2") << "the same map again";
  EXPECT_EQ(registry("pull barn --version " + expected + " -o pulled.byre", "reviewer").exit_code, 0);
  EXPECT_EQ(read("pulled.byre"), read("expected.byre"));
  EXPECT_EQ(registry("accept barn " + expected, "reviewer").exit_code, 0) << "it replaces any version";
}

TEST_F(RegistryWorker, GivesTheReasonWhyAMapIsNotRegisteredOnAPlan) {
  write("plan.pgm", "P5\n2 1\n255\n\xff\x01");
  write("plan.yaml", "image: plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
  EXPECT_EQ(registry("push barn --plan plan.yaml", "reviewer").exit_code, 0);
  EXPECT_EQ(registry("request barn --map " + cli::rendered_room(), "reviewer").exit_code, 0);
  EXPECT_THAT(worker("--once --kinds map").output,
              AllOf(HasSubstr("job 2 done: "), HasSubstr("; not on plan plan: the z axis of the map's body does not")));
  EXPECT_EQ(value("SELECT count(*) FROM byre.version WHERE state = 'proposed'"), "1");
}

using LongRunRegistryWorker = RegistryTest;

// Through the gate, as the hall alone is symmetric. The other floor has no walls.
TEST_F(LongRunRegistryWorker, RegistersTheMapOfARecordingOnThePlanThatItFits) {
  ASSERT_EQ(run("simulate cowshed --divide 2 --rate 8 --gate open --duration 60 -o day --quiet").exit_code, 0);
  write("upper.pgm", "P5\n2 1\n255\n\xff\x01");
  write("upper.yaml", "image: upper.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
  for (const char* const plan : {"upper.yaml", "day/plan/plan.yaml"}) {
    ASSERT_EQ(registry(std::string("push barn --plan ") + plan, "reviewer").exit_code, 0);
  }
  ASSERT_EQ(registry("request barn --map '" + (folder_ / "day").string() + "'", "reviewer").exit_code, 0);
  EXPECT_THAT(worker().output, HasSubstr("; registered on plan.yaml\n"));
  const std::string id = value("SELECT id FROM byre.version");
  ASSERT_EQ(registry("pull barn --version " + id + " -o pulled.byre", "reviewer").exit_code, 0);
  ASSERT_EQ(run("map day -o barn.byre --quiet").exit_code, 0);
  ASSERT_EQ(run("register barn.byre --plan day/plan/plan.yaml --auto -o expected.byre").exit_code, 0);
  EXPECT_EQ(read("pulled.byre"), read("expected.byre"));
}

TEST_F(RegistryWorker, WaitsForARecordingThatItCannotRead) {
  const std::string later = (folder_ / "later").string();
  EXPECT_EQ(registry("request barn --map '" + later + "'", "reviewer").exit_code, 0);
  EXPECT_THAT(worker("--once --kinds map").output, HasSubstr("job 2 failed: " + later));
  EXPECT_THAT(registry("list barn", "reviewer").output, HasSubstr("map " + later + ", waiting, attempt 1: " + later));
  std::filesystem::create_directory_symlink(RenderedFixture::shared().folder(), later);
  connect().run("UPDATE byre.job SET due = now()");
  EXPECT_THAT(worker("--once --kinds map").output, HasSubstr("mapped: 24 of 24 frames"));
  EXPECT_EQ(registry("request barn --map '" + later + "' --calibration /absent.yaml", "reviewer").exit_code, 0);
  EXPECT_THAT(worker("--once --kinds map").output, HasSubstr("job 3 failed: /absent.yaml"));
  EXPECT_EQ(value("SELECT count(*) FROM byre.version WHERE state = 'proposed'"), "1");
}

TEST_F(RegistryWorker, ProposesASummaryOfAVersion) {
  map_room("--poses " + cli::rendered_room(), "dense.byre");  // each frame is a keyframe
  const std::string dense = to_text(map_id(folder_ / "dense.byre"));
  EXPECT_EQ(registry("push annex dense.byre", "reviewer").exit_code, 0);
  EXPECT_EQ(registry("accept annex " + dense, "reviewer").exit_code, 0);
  const std::string request = "request annex --summarise " + dense + " --keyframes ";
  EXPECT_EQ(registry(request + "6", "reviewer").output, "requested    summarise\n");
  EXPECT_THAT(worker("--once --kinds summarise").output, HasSubstr("job 2 done: summary: "));
  const std::string child = value("SELECT id FROM byre.version WHERE state = 'proposed'");
  EXPECT_EQ(value("SELECT parents FROM byre.version WHERE id = $1", {child}), "{" + dense + "}");
  EXPECT_EQ(registry("pull annex --version " + child + " -o summary.byre", "reviewer").exit_code, 0);
  EXPECT_LT(load_map(folder_ / "summary.byre").map.keyframe_count(), 24);
  EXPECT_EQ(run("validate summary.byre").exit_code, 0);
  EXPECT_EQ(registry("accept annex " + child, "reviewer").exit_code, 0);
  EXPECT_EQ(registry(request + "1000", "reviewer").exit_code, 0);
  EXPECT_THAT(worker("--once --kinds summarise").output, HasSubstr("no keyframe can be spared with 1000 for each"));
  EXPECT_EQ(registry("request barn --keyframes 3", "reviewer").exit_code, 2) << "only of a summary";
}

TEST_F(RegistryWorker, SharesTheJobsWithAnotherWorker) {
  for (const char* const site : {"annex", "annex", "barn"}) {
    EXPECT_EQ(registry(std::string("request ") + site + " --merge " + base_ + " " + base_, "reviewer").exit_code, 0);
  }
  const std::vector<std::string> arguments = {"worker", "--once", "--attempts", "1", "--registry", uri("worker")};
  const std::vector<pid_t> workers = {start(arguments), start(arguments)};
  for (const pid_t process : workers) EXPECT_EQ(exit_code_of(process), 0);
  EXPECT_EQ(worker("--once --attempts 1").exit_code, 0) << "jobs of a site that the other worker was at";
  EXPECT_EQ(value("SELECT count(*) FROM byre.job WHERE state IN ('done', 'failed')"), "4");
  EXPECT_EQ(value("SELECT max(attempts) FROM byre.job"), "1");
  EXPECT_EQ(value("SELECT count(*) FROM byre.event WHERE kind SIMILAR TO '(merge|update) (done|failed)'"), "4");
}

// Starts the program and kills it at random moments of a job, then lets another worker finish.
TEST_F(RegistryWorker, EndsItsJobOnceThoughKilledAtRandom) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 8; ++i) {
    const pid_t process =
        start({"worker", "--attempts", "100", "--scratch", folder_.string(), "--registry", uri("worker")});
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 400));
    kill(process, SIGKILL);
    exit_code_of(process);
    connect().run("UPDATE byre.job SET due = now() - interval '1 s' WHERE state IN ('waiting', 'running')");
  }
  EXPECT_EQ(worker("--once --attempts 100 --scratch .").exit_code, 0);
  EXPECT_EQ(value("SELECT count(*) FROM byre.job WHERE state = 'done' AND result IS NOT NULL"), "1");
  EXPECT_EQ(value("SELECT count(*) FROM byre.version WHERE state = 'proposed'"), "1");
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    EXPECT_FALSE(entry.is_directory()) << entry.path() << " is of a killed worker";
  }
}

// The pull of a job waits for a lock, longer than the lease.
TEST_F(RegistryWorker, RenewsTheLeaseOfItsJob) {
  Connection owner = connect();
  Transaction lock(owner);
  owner.run("LOCK TABLE byre.blob_chunk IN ACCESS EXCLUSIVE MODE");
  const pid_t process = start({"worker", "--once", "--lease", "1", "--registry", uri("worker")});
  EXPECT_TRUE(appears("job 1: pulling the sessions", "stderr.txt"));
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  Connection other = connect("worker");
  EXPECT_EQ(other.run("SELECT FROM byre.take_job('other', '1 s', 5)").size(), 0);
  lock.commit();
  EXPECT_EQ(exit_code_of(process), 0);
  EXPECT_EQ(value("SELECT state || ' ' || attempts FROM byre.job"), "done 1");
}

TEST_F(RegistryWorker, StopsAtCtrlCAndReturnsItsJob) {
  Connection owner = connect();
  Transaction lock(owner);
  owner.run("LOCK TABLE byre.blob_chunk IN ACCESS EXCLUSIVE MODE");
  const pid_t process = start({"worker", "--registry", uri("worker")});
  EXPECT_TRUE(appears("job 1: pulling the sessions", "stderr.txt"));
  kill(process, SIGINT);
  lock.commit();
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_EQ(value("SELECT state || ': ' || message FROM byre.job"), "waiting: the worker was stopped");
}

TEST_F(RegistryWorker, ConnectsAgainAfterTheServerWasKilled) {
  connect().run("UPDATE byre.job SET due = now() + interval '1 hour'");
  const pid_t process = start({"worker", "--registry", uri("worker")});
  const auto is_connected = [this] {
    return value("SELECT count(*) FROM pg_stat_activity WHERE usename = 'worker' AND query LIKE '%take_job%'") != "0";
  };
  for (int i = 0; i < 3000 && !is_connected(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  RegistryServer::shared().kill();
  EXPECT_TRUE(appears("connecting again", "stderr.txt"));
  RegistryServer::shared().start();
  connect().run("UPDATE byre.job SET due = now()");
  EXPECT_TRUE(appears("job 1 done: evening", "stdout.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
}

}  // namespace
}  // namespace byre
