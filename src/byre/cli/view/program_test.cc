#include "byre/cli/shared/program_fixture.h"
#include "byre/simulation/rendered_scene.h"

#include <cstdint>
#include <iterator>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

namespace byre::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;

class ViewProgram : public ProgramTest {
 protected:
  const std::string room_ = RenderedFixture::shared().folder().string();
};

TEST_F(ViewProgram, ShowsAMapUntilItIsInterrupted) {
  map_room("", "room.byre");
  const pid_t process = start({"view", (folder_ / "room.byre").string(), "--port", "0"});
  ASSERT_TRUE(appears("until Ctrl-C", "stderr.txt")) << read("stderr.txt");
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 0) << read("stderr.txt");
  EXPECT_THAT(read("stderr.txt"), HasSubstr("viewer: http://127.0.0.1:"));
  EXPECT_THAT(read("stdout.txt"), IsEmpty());
}

TEST_F(ViewProgram, PrintsOnlyItsAddressWhenQuiet) {
  map_room("", "room.byre");
  const pid_t process =
      start({"view", (folder_ / "room.byre").string(), "--port", "0", "--bind", "0.0.0.0", "--quiet"});
  ASSERT_TRUE(appears("?token=", "stderr.txt")) << read("stderr.txt");
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 0) << read("stderr.txt");
  EXPECT_THAT(read("stderr.txt"), MatchesRegex("(viewer: http://[0-9.]+:[0-9]+/\\?token=[0-9a-f]+\n)+"));
  EXPECT_THAT(read("stderr.txt"), AllOf(HasSubstr("viewer: http://127.0.0.1:"), Not(HasSubstr("0.0.0.0"))));
}

TEST_F(ViewProgram, ServesARunAfterItsFilesAreWritten) {
  const pid_t process =
      start({"run", room_, "--trajectory", (folder_ / "path.txt").string(), "--view", "0", "--view-for", "1000000"});
  ASSERT_TRUE(appears("until Ctrl-C", "stderr.txt"));
  EXPECT_THAT(read("path.txt"), Not(IsEmpty()));
  EXPECT_THAT(read("stdout.txt"), HasSubstr("path.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 0);
}

TEST_F(ViewProgram, EndsWithTheRunWithoutATerminal) {
  const Outcome outcome = run("run '" + room_ + "' --frames 0:4 --view 0 </dev/null");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("viewer: ends with the run, as there is no terminal"));
}

TEST_F(ViewProgram, StaysForTheGivenTime) {
  const Outcome outcome = run("run '" + room_ + "' --frames 0:4 --view 0 --view-for 0.2 </dev/null");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("viewer: stays for 0.2 s, or until Ctrl-C\n"));
  EXPECT_THAT(run("run '" + room_ + "' --frames 0:4 --view 0 --view-for 0").errors, HasSubstr("ends with the run\n"));
}

TEST_F(ViewProgram, StaysWithATerminal) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) GTEST_SKIP() << "no terminal available";
  const pid_t process =
      start({"run", room_, "--frames", "0:4", "--view", "0"}, {SIGINT, SIGTERM, SIGHUP}, ptsname(terminal));
  EXPECT_TRUE(appears("until Ctrl-C", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 0);
  close(terminal);
}

// Connections without an accepted request: idle, with an endless request, garbage or a wrong token, and short-lived
// ones.
class HostileCrowd {
 public:
  explicit HostileCrowd(int port) : port_(port) {}
  ~HostileCrowd() {
    for (const int socket : sockets_) close(socket);
  }
  HostileCrowd(const HostileCrowd&) = delete;
  HostileCrowd& operator=(const HostileCrowd&) = delete;

  void add(int count) {
    const std::string garbage(5000, '\xff');
    const std::string_view sent[] = {"", "GET /?token=", garbage, "GET /?token=0 HTTP/1.1\r\nHost: barn\r\n\r\n", ""};
    for (int i = 0; i < count; ++i) {
      const int socket = connect();
      const std::string_view bytes = sent[i % std::size(sent)];
      if (socket >= 0) send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (socket >= 0 && i % std::size(sent) == 4) close(socket);
      if (socket >= 0 && i % std::size(sent) != 4) sockets_.push_back(socket);
    }
  }

 private:
  int connect() const {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (socket >= 0) ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    return socket;
  }

  int port_;
  std::vector<int> sockets_;
};

TEST_F(ViewProgram, LosesNoFrameUnderHostileConnections) {
  const pid_t process = start({"run", room_, "--pace", "live", "--stats", (folder_ / "stats.json").string(), "--view",
                               "0", "--bind", "0.0.0.0", "--view-for", "1000000"});
  const rlimit few{64, 64};
  ASSERT_EQ(prlimit(process, RLIMIT_NOFILE, &few, nullptr), 0) << "before it starts to serve";
  ASSERT_TRUE(appears("viewer: http://127.0.0.1:", "stderr.txt"));
  const std::string said = read("stderr.txt");
  const std::size_t port = said.find("http://127.0.0.1:") + std::string_view("http://127.0.0.1:").size();
  HostileCrowd crowd(std::stoi(said.substr(port)));
  while (!appears("until Ctrl-C", "stderr.txt", std::chrono::milliseconds(50))) crowd.add(15);
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 0) << read("stderr.txt");
  const nlohmann::json counts = nlohmann::json::parse(read("stats.json")).at("counts");
  EXPECT_EQ(counts.at("frames"), 24);
  EXPECT_EQ(counts.at("frames_unreadable"), 0);
  EXPECT_EQ(counts.at("frames_without_right_image"), 0);
}

TEST_F(ViewProgram, ReportsFaultsOfItsOptions) {
  EXPECT_EQ(run("view nothing.byre").exit_code, 3);
  EXPECT_THAT(run("view a.byre --plan plan.yaml -o a.byre").errors, HasSubstr("--overwrite"));
  EXPECT_THAT(run("view a.byre -o b.byre").errors, HasSubstr("--plan"));
  EXPECT_THAT(run("view a.byre --port 70000").errors, HasSubstr("--port"));
  EXPECT_THAT(run("run '" + room_ + "' --view 0 --bind barn").errors, HasSubstr("is not an IP address"));
  EXPECT_THAT(run("run '" + room_ + "' --view 0 --plan plan.yaml").errors, HasSubstr("--map"));
  EXPECT_THAT(run("run '" + room_ + "' --bind 127.0.0.1").errors, HasSubstr("--view"));
}

}  // namespace
}  // namespace byre::cli
