#include "byre/ros2/node/process.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace byre {
namespace {

// Notification socket of a service manager.
class NotifySocket {
 public:
  NotifySocket() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    std::filesystem::remove(path_);
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(socket_);
    std::filesystem::remove(path_);
  }

  std::string next() const {
    std::string text(200, '\0');
    const ssize_t size = recv(socket_, text.data(), text.size(), 0);
    return size < 0 ? "" : text.substr(0, static_cast<std::size_t>(size));
  }

 private:
  std::string path_ = testing::TempDir() + "byre_notify." + std::to_string(getpid());
  int socket_ = -1;
};

TEST(ServiceManager, ReceivesTheStatus) {
  const NotifySocket socket;
  setenv("WATCHDOG_USEC", "60000000", 1);
  ServiceManager manager;
  manager.ready();
  EXPECT_EQ(socket.next(), "READY=1");
  manager.status("trusted;\n20 frames a second");
  EXPECT_EQ(socket.next(), "STATUS=trusted; 20 frames a second");
  manager.status("trusted;\n20 frames a second");
  EXPECT_EQ(socket.next(), "") << "unchanged";
  manager.alive();
  EXPECT_EQ(socket.next(), "WATCHDOG=1");
  manager.alive();
  EXPECT_EQ(socket.next(), "") << "half a minute is not over";
  manager.stopping();
  EXPECT_EQ(socket.next(), "STOPPING=1");
}

TEST(ServiceManager, ExtendsTheWatchdogForLongTasks) {
  const NotifySocket socket;
  setenv("WATCHDOG_USEC", "10000000", 1);
  ServiceManager manager;
  manager.alive();
  EXPECT_EQ(socket.next(), "WATCHDOG=1");
  manager.busy(std::chrono::seconds(300));
  EXPECT_EQ(socket.next(), "WATCHDOG_USEC=300000000");
  manager.alive();
  EXPECT_EQ(socket.next(), "WATCHDOG_USEC=10000000") << "the previous interval";
  EXPECT_EQ(socket.next(), "WATCHDOG=1");
  manager.alive();
  EXPECT_EQ(socket.next(), "") << "half of the time is not over";
}

TEST(ServiceManager, KeepsTheWatchdogForShortTasks) {
  const NotifySocket socket;
  setenv("WATCHDOG_USEC", "60000000", 1);
  ServiceManager manager;
  manager.busy(std::chrono::seconds(30));
  EXPECT_EQ(socket.next(), "");
}

TEST(ServiceManager, IsOptional) {
  unsetenv("NOTIFY_SOCKET");
  ServiceManager manager;
  EXPECT_NO_THROW(manager.ready());
  EXPECT_NO_THROW(manager.alive());
  EXPECT_NO_THROW(manager.busy(std::chrono::seconds(300)));
}

}  // namespace
}  // namespace byre
