// Load of many robots, of many waiting jobs and of updates. Prints the figures of docs/lab/registry.md.

#include "registry_fixture.h"

#include "byre/base/stopwatch.h"
#include "byre/registry/blobs.h"
#include "byre/registry/jobs.h"
#include "byre/registry/versions.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

namespace byre {
namespace {

class LongRunRegistryLoad : public RegistryTest {
 protected:
  static double quantile(std::vector<double> values, double share) {
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  }

  static std::string server_log() {
    std::ostringstream text;
    text << std::ifstream(RegistryServer::shared().folder() / "data/server.log").rdbuf();
    return text.str();
  }

  // Sum of the durations of statements that the server logged, with their parsing and binding.
  static double logged_ms(const std::string& log) {
    const std::string label = "duration: ";
    double sum = 0.0;
    for (std::size_t at = log.find(label); at != std::string::npos; at = log.find(label, at + 1)) {
      sum += std::stod(log.substr(at + label.size(), 20));
    }
    return sum;
  }
};

// Connections of a pool act for robots by SET ROLE, which the policies heed.
TEST_F(LongRunRegistryLoad, AThousandRobotsPushSessionsAndPullMaps) {
  constexpr int kSites = 200, kRobots = 1000, kSessions = 10, kConnections = 8;
  Connection owner = connect();
  owner.run_script(
      "INSERT INTO byre.site (name) SELECT 'site ' || n FROM generate_series(3, 200) n;"
      "SELECT byre.admit('load_' || n, 'robot', 1 + n % 200) FROM generate_series(0, 999) n");
  std::vector<std::string> accepted;
  for (int site = 1; site <= kSites; ++site) {
    const std::vector<std::byte> map = small_map(fmt::format("site {}", site), 10'000'000);
    accepted.push_back(to_text(map_id(map, "")));
    add_version(owner, site, accepted.back(), push_blob(owner, map), {}, "");
    owner.run("SELECT byre.accept($1, $2, '')", {site, accepted.back()});
  }
  std::vector<std::vector<double>> pushes(kConnections), pulls(kConnections);
  const Stopwatch whole;
  {
    std::vector<std::jthread> pool;
    for (int i = 0; i < kConnections; ++i) {
      pool.emplace_back([&, i] {
        Connection connection = connect();
        for (int robot = i; robot < kRobots; robot += kConnections) {
          const int site = 1 + robot % kSites;
          const std::string& map = accepted[static_cast<std::size_t>(site - 1)];
          connection.run_script(fmt::format("SET ROLE load_{}", robot));
          for (int session = 0; session < kSessions; ++session) {
            const std::vector<std::byte> bytes = small_session(fmt::format("{} {}", robot, session), map, 20'000);
            const std::string id = to_text(map_id(bytes, ""));
            const Stopwatch watch;
            add_session(connection, site, id, push_blob(connection, bytes), map, "evening");
            pushes[static_cast<std::size_t>(i)].push_back(watch.seconds());
          }
          const std::filesystem::path path = folder_ / fmt::format("{}.byre", i);
          std::filesystem::remove(path);
          const Stopwatch watch;
          EXPECT_EQ(pull_map(connection, site, {}, path).id, map);
          pulls[static_cast<std::size_t>(i)].push_back(watch.seconds());
        }
      });
    }
  }
  const double seconds = whole.seconds();
  std::vector<double> push, pull;
  for (int i = 0; i < kConnections; ++i) {
    push.insert(push.end(), pushes[static_cast<std::size_t>(i)].begin(), pushes[static_cast<std::size_t>(i)].end());
    pull.insert(pull.end(), pulls[static_cast<std::size_t>(i)].begin(), pulls[static_cast<std::size_t>(i)].end());
  }
  EXPECT_EQ(value("SELECT count(*) FROM byre.session"), std::to_string(kRobots * kSessions));
  EXPECT_EQ(
      value("SELECT count(*) FROM byre.session s JOIN byre.robot r ON r.account = s.added_by AND r.site = s.site"),
      std::to_string(kRobots * kSessions));
  EXPECT_EQ(value("SELECT count(*) FROM byre.job WHERE state = 'waiting'"), std::to_string(kSites));
  std::cout << fmt::format(
      "{} sessions pushed, {} maps of 10 MB pulled in {:.0f} s; push median {:.1f} ms, p95 {:.1f} ms; pull median "
      "{:.0f} "
      "ms, p95 {:.0f} ms; database {}\n",
      push.size(), pull.size(), seconds, 1e3 * quantile(push, 0.5), 1e3 * quantile(push, 0.95),
      1e3 * quantile(pull, 0.5), 1e3 * quantile(pull, 0.95),
      value("SELECT pg_size_pretty(pg_database_size(current_database()))"));
}

TEST_F(LongRunRegistryLoad, JobsWaitByTheThousand) {
  connect().run("INSERT INTO byre.site (name) SELECT 'site ' || n FROM generate_series(3, 200) n");
  connect().run("ALTER ROLE worker SET log_duration = on");
  Connection worker = connect("worker");
  for (const int waiting : {1, 1, 10, 100, 1000}) {
    const std::size_t logged = server_log().size();
    connect().run_script("DELETE FROM byre.job");
    connect().run(
        "INSERT INTO byre.job (site, kind, maps) SELECT 1 + n % 200, 'merge', '{0123456789abcdef, fedcba9876543210}' "
        "FROM generate_series(1, $1::int) n",
        {waiting});
    connect().run_script("VACUUM ANALYZE byre.job");
    std::vector<double> overheads;
    while (true) {
      const Stopwatch watch;
      const auto job = take_job(worker, "worker", {});
      if (!job) break;
      EXPECT_TRUE(renew_lease(worker, *job, {}));
      EXPECT_EQ(end_job(worker, *job, {.message = "nothing to do"}), JobEnd::done);
      overheads.push_back(watch.seconds());
    }
    EXPECT_EQ(overheads.size(), static_cast<std::size_t>(waiting));
    std::cout << fmt::format(
        "{} waiting jobs: median {:.2f} ms, p95 {:.2f} ms to take, renew and end a job; of it the server {:.2f} ms\n",
        waiting, 1e3 * quantile(overheads, 0.5), 1e3 * quantile(overheads, 0.95),
        logged_ms(server_log().substr(logged)) / waiting);
  }
  connect().run("ALTER ROLE worker RESET log_duration");
}

// CPU time of programs that ended, seconds.
double cpu_seconds_of_children() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

// Updates of simulated barns, as many sites as the jobs of a measurement.
TEST_F(LongRunRegistryLoad, WorkersUpdateSites) {
  constexpr int kJobs = 12;
  for (const auto& [day, mission] : {std::pair("day_1", "1"), std::pair("day_2", "2")}) {
    ASSERT_EQ(
        run(fmt::format("simulate cowshed --divide 2 --rate 8 --duration 60 --mission {} --quiet -o {}", mission, day))
            .exit_code,
        0);
  }
  ASSERT_EQ(run("map day_1 -o barn.byre --quiet").exit_code, 0);
  ASSERT_EQ(run("run day_2 --map barn.byre --save-session evening.session --quiet").exit_code, 0);
  Connection owner = connect();
  const auto size = [this] { return std::stod(value("SELECT pg_database_size(current_database())")); };
  int site = 2;  // sites before these
  for (const int workers : {1, 2, 4}) {
    const double bytes_before = size();
    for (int i = 0; i < kJobs; ++i) {
      ++site;
      owner.run("INSERT INTO byre.site (name) VALUES ($1)", {fmt::format("site {}", site)});
      const std::string id = push_file(owner, site, folder_ / "barn.byre", "").id;
      owner.run("SELECT byre.accept($1, $2, '')", {site, id});
      push_file(owner, site, folder_ / "evening.session", "");
    }
    const double cpu_before = cpu_seconds_of_children();
    const Stopwatch watch;
    std::vector<pid_t> processes;
    for (int i = 0; i < workers; ++i) {
      processes.push_back(start({"worker", "--once", "--quiet", "--registry", uri("worker")}));
    }
    for (const pid_t process : processes) EXPECT_EQ(exit_code_of(process), 0);
    const double seconds = watch.seconds();
    EXPECT_EQ(value("SELECT count(*) FROM byre.job WHERE state = 'done' AND result IS NOT NULL"),
              std::to_string(site - 2));
    std::cout << fmt::format(
        "{} workers: {} updates in {:.0f} s, {:.0f} an hour, {:.2f} CPU s each; map {:.1f} MB, session {:.1f} MB, "
        "child {} bytes, "
        "database "
        "+{:.1f} MB\n",
        workers, kJobs, seconds, 3600.0 * kJobs / seconds, (cpu_seconds_of_children() - cpu_before) / kJobs,
        1e-6 * static_cast<double>(read("barn.byre").size()),
        1e-6 * static_cast<double>(read("evening.session").size()),
        value("SELECT max(b.size) FROM byre.job j JOIN byre.version v ON v.site = j.site AND v.id = j.result JOIN "
              "byre.blob b ON b.hash = v.blob"),
        1e-6 * (size() - bytes_before));
  }
}

}  // namespace
}  // namespace byre
