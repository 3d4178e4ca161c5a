// Long-run test of byre node: BYRE_NODE_SOAK_FRAMES, docs/lab/ros2.md.

#include "staying_up_scene.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

namespace byre::testing_ros2 {
namespace {

// A service manager's notification socket; measures the node's longest silence.
class Watchdog {
 public:
  explicit Watchdog(const fs::path& folder) : path_(folder / "notify") {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.string().copy(address.sun_path, sizeof address.sun_path - 1);
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    reader_ = std::jthread([this](const std::stop_token& stop) { read_until(stop); });
  }
  ~Watchdog() {
    if (reader_.joinable()) stop();
    close(socket_);
  }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  static constexpr std::chrono::seconds kTime{10};  // WatchdogSec of byre.service
  std::vector<std::string> variables() const {
    return {"NOTIFY_SOCKET=" + path_.string(),
            "WATCHDOG_USEC=" + std::to_string(std::chrono::microseconds(kTime).count())};
  }

  // Includes the time since the last notification.
  void stop() {
    reader_.request_stop();
    reader_.join();
    note(Clock::now());
  }
  // Valid after stop().
  int signs() const { return signs_; }
  double longest_silence() const { return longest_; }  // seconds

 private:
  void read_until(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd polled{socket_, POLLIN, 0};
      if (poll(&polled, 1, 100) <= 0) continue;
      std::array<char, 4096> text{};
      const ssize_t size = recv(socket_, text.data(), text.size(), 0);
      if (size <= 0) continue;
      const std::string_view line(text.data(), static_cast<std::size_t>(size));
      if (line == "READY=1") last_ = Clock::now();
      if (line != "WATCHDOG=1") continue;
      note(Clock::now());
      ++signs_;
    }
  }
  void note(Clock::time_point now) {
    if (last_) longest_ = std::max(longest_, std::chrono::duration<double>(now - *last_).count());
    last_ = now;
  }

  fs::path path_;
  int socket_ = -1;
  // Written by the reader thread until it is stopped.
  std::optional<Clock::time_point> last_;
  double longest_ = 0.0;
  int signs_ = 0;
  std::jthread reader_;
};

struct Usage {
  long resident_kb = 0;
  long anonymous_kb = 0;  // without file-backed memory
  long descriptors = 0;
};

Usage usage_of(pid_t process) {
  const fs::path about = "/proc/" + std::to_string(process);
  Usage usage;
  std::ifstream status(about / "status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) usage.resident_kb = std::stol(line.substr(6));
    if (line.starts_with("RssAnon:")) usage.anonymous_kb = std::stol(line.substr(8));
  }
  usage.descriptors = std::distance(fs::directory_iterator(about / "fd"), fs::directory_iterator());
  return usage;
}

TEST_F(ByreNodeStaysUp, RunsVisitAfterVisit) {
  const int frames = number_from_environment("BYRE_NODE_SOAK_FRAMES", 200);
  // Memory grows until the node's path has its maximum length, so short runs do not evaluate it.
  constexpr int kSettled = 20'000;  // frames
  constexpr int kJudged = 40'000;   // frames
  constexpr double kGrowth = 1.05;
  Watchdog watchdog(folder_);
  NodePeers peers(domain_);
  NodeProcess node(folder_, config("  map: " + Visits::shared().whole_map().string() + "\n"), domain_,
                   watchdog.variables());
  ASSERT_TRUE(peers.is_connected()) << node.stderr_output();
  Player player(1);
  std::vector<Usage> tenths;
  int with_pose = 0;
  const auto begin = Clock::now();
  for (int i = 0; i < frames; ++i) {
    const auto answer = peers.answer_to(player.next(), 1000s + i * kFrameTime);
    ASSERT_TRUE(answer) << "frame " << i << "\n" << node.stderr_output();
    if (answer->has_pose) ++with_pose;
    if ((i + 1) * 10 / frames == i * 10 / frames) continue;
    peers.clear();
    tenths.push_back(usage_of(node.process()));
    const double seconds = seconds_since(begin);
    std::printf("%7d frames %7.1f s %6.1f frames/s  VmRSS %ld kB  RssAnon %ld kB  %ld descriptors\n", i + 1, seconds,
                (i + 1) / seconds, tenths.back().resident_kb, tenths.back().anonymous_kb, tenths.back().descriptors);
    std::fflush(stdout);
  }
  watchdog.stop();
  std::printf("%d of %d frames with a pose, %d cuts, %d signs of life, longest silence %.1f s\n", with_pose, frames,
              player.cuts(), watchdog.signs(), watchdog.longest_silence());
  EXPECT_GT(with_pose, frames / 2);
  EXPECT_GE(watchdog.signs(), 1);
  EXPECT_LT(watchdog.longest_silence(), watchdog.kTime.count());
  EXPECT_EQ(tenths.back().descriptors, tenths.front().descriptors);
  if (frames >= kJudged) {
    const auto settled = static_cast<std::size_t>((10LL * kSettled + frames - 1) / frames - 1);
    EXPECT_LT(static_cast<double>(tenths.back().resident_kb),
              kGrowth * static_cast<double>(tenths[settled].resident_kb));
    EXPECT_LT(static_cast<double>(tenths.back().anonymous_kb),
              kGrowth * static_cast<double>(tenths[settled].anonymous_kb));
  }
  EXPECT_EQ(node.stop(), 0) << node.stderr_output();
}

}  // namespace
}  // namespace byre::testing_ros2
