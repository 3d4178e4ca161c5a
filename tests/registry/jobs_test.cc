// Queue of jobs: leases, retries, jobs set aside, and workers and servers that are killed.

#include "registry_fixture.h"

#include "byre/registry/blobs.h"
#include "byre/registry/jobs.h"
#include "byre/registry/versions.h"

#include <csignal>
#include <functional>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace byre {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kBarn = 1, kAnnex = 2;

class RegistryJobs : public RegistryTest {
 protected:
  void request_merge(std::int64_t site) const {
    connect("reviewer")
        .run("INSERT INTO byre.job (site, kind, maps) VALUES ($1, 'merge', $2)",
             {site, std::vector<std::string>{"0123456789abcdef", "fedcba9876543210"}});
  }

  std::string state(std::int64_t job) const { return value("SELECT state FROM byre.job WHERE id = $1", {job}); }

  // Ends leases and delays.
  void make_all_due() const {
    connect().run("UPDATE byre.job SET due = now() - interval '1 s' WHERE state IN ('waiting', 'running')");
  }

  // Result with a map as child, written to a folder.
  static JobResult result_of(const RegistryJob& job, const std::filesystem::path& folder) {
    const std::string note = fmt::format("job {}", job.id);
    const std::filesystem::path path = folder / fmt::format("child_{}_{}.byre", job.id, getpid());
    const std::vector<std::byte> bytes = small_map(note, 3000);
    std::ofstream(path).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return {.message = note, .child = path};
  }

  // A process that takes and ends jobs until it is killed. A job takes it up to 40 ms.
  pid_t start_worker(std::uint64_t seed) const {
    const pid_t process = fork();
    if (process != 0) return process;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::mt19937_64 random(seed);
    const auto work = [&random] { std::this_thread::sleep_for(std::chrono::microseconds(random() % 20000)); };
    while (true) {
      try {
        Connection connection = connect("worker");
        while (true) {
          const auto job = take_job(connection, std::to_string(getpid()), {.max_attempts = 1000});
          work();
          if (!job) continue;
          const JobResult result = result_of(*job, folder_);
          end_job(connection, *job, result);
          work();
        }
      } catch (const std::exception&) {  // the server was killed
        work();
      }
    }
  }

  // Each job is done, with one version of its own, whose bytes are whole.
  void expect_one_result_each(int jobs) const {
    Connection owner = connect();
    EXPECT_EQ(owner.run("SELECT FROM byre.job WHERE state = 'done'").size(), jobs);
    EXPECT_EQ(owner
                  .run("SELECT FROM byre.version v JOIN byre.job j ON j.site = v.site AND j.result = v.id "
                       "WHERE v.note = 'job ' || j.id")
                  .size(),
              jobs);
    EXPECT_EQ(owner.run("SELECT FROM byre.version").size(), jobs);
    EXPECT_EQ(owner.run("SELECT FROM byre.event WHERE kind = 'merge done'").size(), jobs);
    EXPECT_EQ(owner.run("SELECT FROM byre.event WHERE kind = 'proposed'").size(), jobs);
    EXPECT_EQ(owner.run("SELECT FROM byre.chunk WHERE hash <> sha256(data)").size(), 0);
    const Rows rows = owner.run("SELECT site, id FROM byre.version");
    for (int row = 0; row < rows.size(); row += 7) {
      const std::filesystem::path path = folder_ / "pulled.byre";
      EXPECT_NO_THROW(pull_map(owner, rows.number(row, 0), rows.text(row, 1), path));
    }
  }

  void request_merges(int count, std::uint64_t seed) const {
    connect().run(
        "INSERT INTO byre.job (site, kind, maps) SELECT 1 + ($2::bigint + n) % 22, 'merge', "
        "'{0123456789abcdef, fedcba9876543210}' FROM generate_series(1, $1::int) n",
        {count, static_cast<std::int64_t>(seed % 1000)});
  }

  // Kills workers at random while jobs arrive, and the server now and then, and lets the rest finish.
  void kill_at_random(int workers, int kills, int server_kills, std::uint64_t seed) const {
    constexpr int kJobsForEach = 3;  // jobs that arrive with each kill
    connect().run("INSERT INTO byre.site (name) SELECT 'site ' || n FROM generate_series(1, 20) n");
    std::mt19937_64 random(seed);
    std::vector<pid_t> running;
    for (int i = 0; i < workers; ++i) running.push_back(start_worker(random()));
    int killed_at_work = 0;
    for (int i = 0; i < kills; ++i) {
      request_merges(kJobsForEach, random());
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 20000));
      pid_t& victim = running[random() % running.size()];
      ::kill(victim, SIGKILL);
      waitpid(victim, nullptr, 0);
      if (server_kills > 0 && i % (kills / server_kills) == 0) {
        RegistryServer::shared().kill();
        RegistryServer::shared().start();
        make_all_due();
      }
      killed_at_work +=
          connect()
              .run("UPDATE byre.job SET due = now() WHERE state = 'running' AND worker = $1", {std::to_string(victim)})
              .changed();
      if (random() % 10 == 0) make_all_due();  // ends leases of living workers, too
      victim = start_worker(random());
    }
    const auto is_done = [this] { return value("SELECT count(*) FROM byre.job WHERE state <> 'done'") == "0"; };
    for (int i = 0; i < 60 && !is_done(); ++i) {
      make_all_due();
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
    for (const pid_t process : running) {
      ::kill(process, SIGKILL);
      waitpid(process, nullptr, 0);
    }
    std::cout << fmt::format("{} of {} workers were killed at work; {} attempts at {} jobs\n", killed_at_work, kills,
                             value("SELECT sum(attempts) FROM byre.job"), kills * kJobsForEach);
    EXPECT_GT(killed_at_work, 0);
    expect_one_result_each(kills * kJobsForEach);
  }
};

TEST_F(RegistryJobs, AreTakenOnceAndOneForEachSite) {
  Connection first = connect("worker"), second = connect("worker");
  request_merge(kBarn);
  request_merge(kBarn);
  request_merge(kAnnex);
  const auto one = take_job(first, "first", {}), other = take_job(second, "second", {});
  ASSERT_TRUE(one && other);
  EXPECT_EQ(one->site, kBarn);
  EXPECT_EQ(one->maps, (std::vector<std::string>{"0123456789abcdef", "fedcba9876543210"}));
  EXPECT_EQ(other->site, kAnnex);
  EXPECT_FALSE(take_job(first, "first", {})) << "the barn has a running job";
  EXPECT_EQ(end_job(first, *one, result_of(*one, folder_)), JobEnd::done);
  EXPECT_EQ(end_job(first, *one, result_of(*one, folder_)), JobEnd::done) << "again, after a broken connection";
  EXPECT_EQ(value("SELECT count(*) FROM byre.version"), "1");
  EXPECT_TRUE(take_job(first, "first", {}));
}

TEST_F(RegistryJobs, HaveWhatTheirKindNeeds) {
  Connection worker = connect("worker");
  EXPECT_THAT(refusal("reviewer", "INSERT INTO byre.job (site, kind) VALUES (1, 'map')"), HasSubstr("job_recording"));
  EXPECT_THAT(
      refusal("reviewer", "INSERT INTO byre.job (site, kind, maps) VALUES (1, 'summarise', '{0123456789abcdef}')"),
      HasSubstr("job_keyframes"));
  EXPECT_THAT(refusal("reviewer", "INSERT INTO byre.job (site, kind) VALUES (1, 'merge')"), HasSubstr("job_maps"));
  EXPECT_THAT(refusal("reviewer", "INSERT INTO byre.job (site, kind) VALUES (1, 'draw')"), HasSubstr("job_"));
  EXPECT_THAT(refusal("robot_barn", "INSERT INTO byre.job (site, kind, recording) VALUES (1, 'map', '/day_1')"),
              HasSubstr("permission denied"));
  connect("reviewer").run("INSERT INTO byre.job (site, kind, recording) VALUES (1, 'map', '/day_1')");
  EXPECT_EQ(worker.run("SELECT FROM byre.take_job('a worker of schema 3', '60 s', 5)").size(), 0);
  EXPECT_FALSE(take_job(worker, "worker", {.kinds = {"update", "summarise"}}));
  const auto job = take_job(worker, "worker", {});
  ASSERT_TRUE(job);
  EXPECT_EQ(job->kind + job->recording + job->calibration, "map/day_1");
  EXPECT_EQ(job->maps.size(), 0u);
}

TEST_F(RegistryJobs, AreTakenAgainAfterTheirLease) {
  Connection first = connect("worker"), second = connect("worker");
  request_merge(kBarn);
  const auto lost = take_job(first, "first", {});
  ASSERT_TRUE(lost);
  EXPECT_TRUE(renew_lease(first, *lost, {}));
  EXPECT_FALSE(take_job(second, "second", {}));
  make_all_due();
  const auto taken = take_job(second, "second", {});
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->id, lost->id);
  EXPECT_FALSE(renew_lease(first, *lost, {}));
  EXPECT_EQ(end_job(first, *lost, result_of(*lost, folder_)), JobEnd::lost);
  fail_job(first, *lost, {}, "too late");
  EXPECT_EQ(state(lost->id), "running");
  EXPECT_EQ(value("SELECT count(*) FROM byre.version"), "0");
  EXPECT_EQ(end_job(second, *taken, result_of(*taken, folder_)), JobEnd::done);
}

TEST_F(RegistryJobs, WaitLongerAfterEachFailureAndAreSetAside) {
  Connection worker = connect("worker");
  const QueueOptions options{.max_attempts = 3};
  request_merge(kBarn);
  for (int attempt = 1; attempt <= 3; ++attempt) {
    const auto job = take_job(worker, "worker", options);
    ASSERT_TRUE(job);
    EXPECT_EQ(job->attempt, attempt);
    fail_job(worker, *job, options, "no such map");
    EXPECT_EQ(state(job->id), attempt < 3 ? "waiting" : "failed");
    const double wait_s = std::stod(value("SELECT extract(epoch FROM due - now()) FROM byre.job"));
    EXPECT_THAT(wait_s, testing::DoubleNear(10.0 * (1 << (attempt - 1)), 8.0));
    EXPECT_FALSE(take_job(worker, "worker", options));
    make_all_due();
  }
  EXPECT_EQ(value("SELECT kind || ': ' || reason FROM byre.event"), "merge failed: no such map");
  EXPECT_THAT(registry("list barn", "reviewer").output, HasSubstr("merge, failed, attempt 3: no such map"));
}

TEST_F(RegistryJobs, ThatEndTheirWorkersAreSetAside) {
  Connection worker = connect("worker");
  request_merge(kBarn);
  for (int attempt = 1; attempt <= 2; ++attempt) {
    EXPECT_TRUE(take_job(worker, "host:7", {.max_attempts = 2}));
    make_all_due();
  }
  EXPECT_FALSE(take_job(worker, "host:8", {.max_attempts = 2}));
  EXPECT_EQ(state(1), "failed");
  EXPECT_EQ(value("SELECT message FROM byre.job"), "no attempt ended; the last by host:7");
}

TEST_F(RegistryJobs, OfAnUpdateWaitIfAnotherVersionIsAcceptedMeanwhile) {
  Connection reviewer = connect("reviewer"), worker = connect("worker");
  std::vector<std::string> ids;
  for (const char* const note : {"first", "second"}) {
    const std::vector<std::byte> map = small_map(note);
    ids.push_back(to_text(map_id(map, note)));
    add_version(reviewer, kBarn, ids.back(), push_blob(reviewer, map), {}, "");
  }
  reviewer.run("SELECT byre.accept(1, $1, '')", {ids[0]});
  EXPECT_EQ(registry("request barn", "reviewer").output, "requested    update\n");
  EXPECT_EQ(registry("request barn", "reviewer").output, "requested    update, as before\n");
  const auto job = take_job(worker, "worker", {});
  ASSERT_TRUE(job);
  JobResult result = result_of(*job, folder_);
  result.base = ids[0];
  result.parents = {ids[0]};
  reviewer.run("SELECT byre.accept(1, $1, '')", {ids[1]});
  EXPECT_EQ(end_job(worker, *job, result), JobEnd::outdated);
  EXPECT_EQ(state(job->id), "waiting");
  EXPECT_EQ(value("SELECT count(*) FROM byre.version"), "2");
}

TEST_F(RegistryJobs, OfOneUpdateSupersedeTheProposalBefore) {
  Connection reviewer = connect("reviewer"), worker = connect("worker"), robot = connect("robot_barn");
  const std::vector<std::byte> map = small_map("base");
  const std::string base = to_text(map_id(map, ""));
  add_version(reviewer, kBarn, base, push_blob(reviewer, map), {}, "");
  reviewer.run("SELECT byre.accept(1, $1, '')", {base});
  std::vector<std::string> sessions, children;
  for (const char* const day : {"monday", "tuesday"}) {
    const std::vector<std::byte> session = small_session(day, base);
    sessions.push_back(to_text(map_id(session, "")));
    add_session(robot, kBarn, sessions.back(), push_blob(robot, session), base, day);
    const auto job = take_job(worker, "worker", {});
    ASSERT_TRUE(job);
    JobResult result = result_of(*job, folder_);
    result.base = base;
    result.parents = {base};
    result.sessions = sessions;  // includes the open ones
    EXPECT_EQ(end_job(worker, *job, result), JobEnd::done);
    children.push_back(to_text(map_id(*result.child)));
  }
  EXPECT_EQ(value("SELECT state || ', ' || reason FROM byre.version WHERE id = $1", {children[0]}),
            "retired, superseded by " + children[1]);
  EXPECT_EQ(value("SELECT count(*) FROM byre.session WHERE state = 'open'"), "2");
  EXPECT_EQ(registry("accept barn " + children[1], "reviewer").exit_code, 0);
  EXPECT_EQ(value("SELECT string_agg(DISTINCT reason, '') FROM byre.session WHERE state = 'closed'"),
            "accepted with " + children[1]);
  EXPECT_EQ(value("SELECT count(*) FROM byre.session WHERE state = 'open'"), "0");
}

TEST_F(RegistryJobs, EndWithOneResultEachThoughWorkersAreKilled) {
  kill_at_random(2, 40, 0, 1);
}

TEST_F(RegistryJobs, EndWithOneResultEachThoughTheServerIsKilled) {
  kill_at_random(2, 10, 2, 2);
}

class LongRunRegistryJobs : public RegistryJobs {};

TEST_F(LongRunRegistryJobs, EndWithOneResultEachThoughWorkersAndServerAreKilled) {
  kill_at_random(8, 500, 20, 3);
}

}  // namespace
}  // namespace byre
