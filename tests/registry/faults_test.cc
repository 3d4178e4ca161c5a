// Networks that are cut in each message, and full disks, of the server and of a worker.

#include "cutting_proxy.h"
#include "registry_fixture.h"

#include "byre/registry/blobs.h"
#include "byre/registry/jobs.h"
#include "byre/registry/versions.h"

#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <unistd.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kBarn = 1;
constexpr std::size_t kMapBytes = 1'500'000;  // two chunks

class RegistryOverCutNetwork : public RegistryTest {
 protected:
  // Runs an action once without a cut, then once for each place to cut. The connection is open before. The number of
  // an action has three digits, so that all send the same number of bytes.
  int run_with_cuts(CuttingProxy& proxy, const std::string& account,
                    const std::function<void(Connection&, const std::string& number)>& action) const {
    Connection connection(proxy.uri(database_, account));
    connection.run("SELECT 1");  // the server has sent all of the start
    proxy.begin({});
    action(connection, "000");
    const std::vector<CuttingProxy::Cut> cuts = proxy.places_to_cut();
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      connection.run("SELECT 1");
      proxy.begin(cuts[i]);
      action(connection, fmt::format("{:03}", i + 1));
      EXPECT_TRUE(proxy.has_cut()) << "byte " << cuts[i].byte << " of side " << static_cast<int>(cuts[i].side);
    }
    return static_cast<int>(cuts.size()) + 1;
  }

  // Bytes of a version, through a file in memory: pulls wait for the disk.
  static std::string pull(Connection& connection, const std::optional<std::string>& id) {
    const std::filesystem::path path = fmt::format("/dev/shm/byre_pulled.{}", getpid());
    pull_map(connection, kBarn, id, path);
    std::ostringstream bytes;
    bytes << std::ifstream(path).rdbuf();
    std::filesystem::remove(path);
    return bytes.str();
  }

  static std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  static std::filesystem::path server_socket() {
    return RegistryServer::shared().folder() / "socket" / ".s.PGSQL.5432";
  }
};

TEST_F(RegistryOverCutNetwork, MapsArePushedOnceWithAllBytes) {
  CuttingProxy proxy(server_socket());
  std::vector<std::pair<std::string, std::filesystem::path>> pushed;
  const int pushes = run_with_cuts(proxy, "reviewer", [&](Connection& connection, const std::string& number) {
    const std::filesystem::path path = folder_ / (number + ".byre");
    write(path.filename().string(), text_of(small_map(number, kMapBytes)));
    pushed.emplace_back(push_file(connection, kBarn, path, "").id, path);
  });
  EXPECT_GT(pushes, 20);
  EXPECT_EQ(value("SELECT count(*) FROM byre.version"), std::to_string(pushes));
  EXPECT_EQ(value("SELECT count(*) FROM byre.event WHERE kind = 'proposed'"), std::to_string(pushes));
  EXPECT_EQ(value("SELECT count(*) FROM byre.blob"), std::to_string(pushes));
  Connection owner = connect();
  for (const auto& [id, path] : pushed) {
    EXPECT_EQ(pull(owner, id), read(path.filename().string())) << path;
  }
}

TEST_F(RegistryOverCutNetwork, MapsArePulledWithAllBytes) {
  Connection reviewer = connect("reviewer");
  write_small_map("barn.byre", "barn", kMapBytes);
  const std::string id = push_file(reviewer, kBarn, folder_ / "barn.byre", "").id;
  reviewer.run("SELECT byre.accept(1, $1, '')", {id});
  CuttingProxy proxy(server_socket());
  const int pulls = run_with_cuts(proxy, "robot_barn", [&](Connection& connection, const std::string& number) {
    EXPECT_EQ(pull(connection, {}), read("barn.byre")) << number;
  });
  EXPECT_GT(pulls, 20);
}

TEST_F(RegistryOverCutNetwork, JobsEndOnceWithOneResult) {
  CuttingProxy proxy(server_socket());
  const auto request = [this] {
    connect("reviewer").run("INSERT INTO byre.job (site, kind, recording) VALUES (1, 'map', '/day_1')");
  };
  const int jobs = run_with_cuts(proxy, "worker", [&](Connection& connection, const std::string& number) {
    request();
    Connection direct = connect("worker");
    const auto job = take_job(direct, "worker", {});
    ASSERT_TRUE(job);
    write(number + ".byre", text_of(small_map(number)));
    const JobResult result{.message = number, .child = folder_ / (number + ".byre")};
    EXPECT_EQ(end_job(connection, *job, result), JobEnd::done);
  });
  EXPECT_GT(jobs, 20);
  for (const char* const count : {"SELECT count(*) FROM byre.job WHERE state = 'done' AND attempts = 1",
                                  "SELECT count(DISTINCT result) FROM byre.job", "SELECT count(*) FROM byre.version",
                                  "SELECT count(*) FROM byre.event WHERE kind = 'map done'",
                                  "SELECT count(*) FROM byre.event WHERE kind = 'proposed'"}) {
    EXPECT_EQ(value(count), std::to_string(jobs)) << count;
  }
}

TEST_F(RegistryOverCutNetwork, AJobWhoseTakingWasNotAnsweredIsTakenAgain) {
  CuttingProxy proxy(server_socket());
  connect("reviewer").run("INSERT INTO byre.job (site, kind, recording) VALUES (1, 'map', '/day_1')");
  Connection connection(proxy.uri(database_, "worker"));
  connection.run("SELECT 1");
  proxy.begin(CuttingProxy::Cut{CuttingProxy::Side::server, 0});
  EXPECT_THROW(take_job(connection, "worker", {}), ConnectionLost);
  connection.reconnect();
  EXPECT_FALSE(take_job(connection, "worker", {})) << "its lease has not ended";
  connect().run("UPDATE byre.job SET due = now()");
  const auto job = take_job(connection, "worker", {});
  ASSERT_TRUE(job);
  EXPECT_EQ(job->attempt, 2);
}

// File system of limited size at a folder. Mounting it needs root.
class SmallDisk {
 public:
  SmallDisk(std::filesystem::path folder, const std::string& size) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
    is_mounted_ = mount("tmpfs", folder_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  }
  ~SmallDisk() {
    if (is_mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool is_mounted() const { return is_mounted_; }
  void grow() const { EXPECT_EQ(mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, "size=64m"), 0); }

 private:
  std::filesystem::path folder_;
  bool is_mounted_ = false;
};

class RegistryOnFullDisk : public RegistryTest {
 protected:
  // A job for a worker: to update the barn by a session of 300 kB.
  void request_update() const {
    Connection reviewer = connect("reviewer");
    const std::string base = write_small_map("barn.byre", "barn");
    push_file(reviewer, kBarn, folder_ / "barn.byre", "");
    reviewer.run("SELECT byre.accept(1, $1, '')", {base});
    const std::vector<std::byte> session = small_session("evening", base, 300'000);
    add_session(reviewer, kBarn, to_text(map_id(session, "")), push_blob(reviewer, session), base, "evening");
  }

  // The job failed for a reason, is due, and is done by a worker without the fault.
  void expect_done_later(const std::string& failure, const std::string& reason, const std::string& arguments) const {
    EXPECT_THAT(failure, AllOf(HasSubstr("job 1 failed: "), HasSubstr(reason)));
    EXPECT_EQ(value("SELECT state || ' ' || attempts FROM byre.job"), "waiting 1");
    EXPECT_THAT(registry("list barn", "reviewer").output, HasSubstr(reason));
    EXPECT_EQ(value("SELECT state FROM byre.session"), "open");
    connect().run("UPDATE byre.job SET due = now()");
    EXPECT_THAT(worker(arguments).output, HasSubstr("job 1 done: "));
    EXPECT_EQ(value("SELECT state || ' ' || attempts FROM byre.job"), "done 2");
  }
};

TEST_F(RegistryOnFullDisk, OfTheServerAResultIsStoredOnceThereIsSpace) {
  const std::string name = "small_" + database_;
  const std::filesystem::path folder = RegistryServer::shared().folder() / name;
  const SmallDisk disk(folder, "1m");
  if (!disk.is_mounted()) GTEST_SKIP() << "only root may mount a small file system";
  ASSERT_EQ(std::system(fmt::format("chown {} '{}'", RegistryServer::shared().owner(), folder.string()).c_str()), 0);
  Connection owner = connect(), worker = connect("worker");
  owner.run_script(fmt::format("CREATE TABLESPACE {} LOCATION '{}'", name, folder.string()));
  owner.run_script("ALTER TABLE byre.chunk SET TABLESPACE " + name);
  connect("reviewer").run("INSERT INTO byre.job (site, kind, recording) VALUES (1, 'map', '/day_1')");
  write_small_map("child.byre", "child", 3 << 20);
  const JobResult result{.message = "mapped", .child = folder_ / "child.byre"};

  auto job = take_job(worker, "worker", {});
  ASSERT_TRUE(job);
  std::stop_source stop;
  stop.request_stop();
  worker.stop_by(stop.get_token());  // one attempt
  try {
    end_job(worker, *job, result);
    ADD_FAILURE() << "the disk of the server is not full";
  } catch (const ConnectionLost& lost) {
    EXPECT_THAT(lost.what(), AllOf(HasSubstr("No space left on device"), HasSubstr("free disk space")));
  }
  EXPECT_EQ(value("SELECT count(*) FROM byre.version"), "0");
  EXPECT_EQ(value("SELECT state FROM byre.job"), "running");

  disk.grow();
  connect().run("UPDATE byre.job SET due = now()");  // end of the lease
  job = take_job(worker, "worker", {});
  ASSERT_TRUE(job);
  EXPECT_EQ(end_job(worker, *job, result), JobEnd::done);
  EXPECT_EQ(value("SELECT count(*) FROM byre.version"), "1");
  EXPECT_EQ(value("SELECT count(*) FROM byre.chunk WHERE hash = sha256(data)"), "4");
  pull_map(worker, kBarn, to_text(map_id(*result.child)), folder_ / "pulled.byre");
  EXPECT_EQ(read("pulled.byre"), read("child.byre"));
  owner.run_script("ALTER TABLE byre.chunk SET TABLESPACE pg_default");
  owner.run_script("DROP TABLESPACE " + name);
}

TEST_F(RegistryOnFullDisk, OfAWorkerItsJobIsDoneOnceThereIsSpace) {
  const SmallDisk disk(folder_ / "small", "100k");
  if (!disk.is_mounted()) GTEST_SKIP() << "only root may mount a small file system";
  request_update();
  const std::string failure = worker("--once --scratch small").output;
  disk.grow();
  expect_done_later(failure, "No space left on device (free disk space", "--once --scratch small");
}

TEST_F(RegistryOnFullDisk, BeyondAWorkersLimitItsJobIsDoneByAnother) {
  request_update();
  const std::string command =
      fmt::format("ulimit -f 100; cd '{}' && '{}' worker --once --registry '{}' >stdout.txt 2>&1", folder_.string(),
                  BYRE_PROGRAM, uri("worker"));
  EXPECT_EQ(std::system(command.c_str()), 0);
  expect_done_later(read("stdout.txt"), "File too large (raise the limit of file sizes (ulimit -f))", "--once");
}

}  // namespace
}  // namespace byre
