#include "cutting_proxy.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace byre {
namespace {

void require(bool is_done) {
  if (!is_done) throw std::runtime_error(std::string("the proxy fails: ") + std::strerror(errno));
}

bool send_all(int to, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = send(to, data, size, MSG_NOSIGNAL);
    if (sent <= 0) return false;
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

}  // namespace

CuttingProxy::CuttingProxy(std::filesystem::path socket) : socket_(std::move(socket)) {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  require(bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) == 0 && listen(listener_, 8) == 0 &&
          getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
          pipe2(wake_.data(), O_CLOEXEC) == 0);
  port_ = ntohs(address.sin_port);
  thread_ = std::jthread([this] { serve(); });
}

CuttingProxy::~CuttingProxy() {
  close(wake_[1]);
  thread_.join();
  close(wake_[0]);
  close(listener_);
}

std::string CuttingProxy::uri(const std::string& database, const std::string& account) const {
  return fmt::format("host=127.0.0.1 port={} sslmode=disable gssencmode=disable dbname={} user={}", port_, database,
                     account);
}

void CuttingProxy::begin(std::optional<Cut> cut) {
  const std::scoped_lock lock(mutex_);
  cut_ = cut;
  has_cut_ = false;
  sent_ = {};
  speaker_.reset();
  messages_.clear();
}

void CuttingProxy::be_silent(bool is_silent) {
  const std::scoped_lock lock(mutex_);
  is_silent_ = is_silent;
}

bool CuttingProxy::has_cut() const {
  const std::scoped_lock lock(mutex_);
  return has_cut_;
}

std::vector<CuttingProxy::Cut> CuttingProxy::places_to_cut() const {
  const std::scoped_lock lock(mutex_);
  std::vector<Cut> places;
  for (std::size_t i = 0; i < messages_.size(); ++i) {
    const auto [side, first] = messages_[i];
    const std::size_t end = i + 2 < messages_.size() ? messages_[i + 2].byte : sent_[static_cast<std::size_t>(side)];
    places.push_back({side, first});
    places.push_back({side, (first + end) / 2});
  }
  return places;
}

std::optional<CuttingProxy::Pair> CuttingProxy::accept_client() const {
  Pair pair;
  pair.sockets[0] = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  pair.sockets[1] = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  if (pair.sockets[0] >= 0 &&
      connect(pair.sockets[1], reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    return pair;
  }
  for (const int socket : pair.sockets) close(socket);
  return std::nullopt;
}

bool CuttingProxy::forward(const Pair& pair, Side from) {
  const auto side = static_cast<std::size_t>(from);
  std::array<char, 1 << 16> buffer;
  const ssize_t received = recv(pair.sockets[side], buffer.data(), buffer.size(), 0);
  if (received <= 0) return false;
  auto size = static_cast<std::size_t>(received);
  bool is_cut = false;
  {
    const std::scoped_lock lock(mutex_);
    if (speaker_ != from) messages_.push_back({from, sent_[side]});
    speaker_ = from;
    sent_[side] += size;
    is_cut = cut_ && cut_->side == from && cut_->byte < sent_[side];
    if (is_silent_) return true;
    if (is_cut) {
      size -= std::min(size, sent_[side] - cut_->byte);
      cut_.reset();
      has_cut_ = true;
    }
  }
  return send_all(pair.sockets[1 - side], buffer.data(), size) && !is_cut;
}

void CuttingProxy::serve() {
  std::vector<Pair> pairs;
  while (true) {
    std::vector<pollfd> polled = {{wake_[0], POLLIN, 0}, {listener_, POLLIN, 0}};
    for (const Pair& pair : pairs) {
      for (const int socket : pair.sockets) polled.push_back({socket, POLLIN, 0});
    }
    poll(polled.data(), polled.size(), -1);
    if (polled[0].revents != 0) break;
    std::vector<Pair> kept;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      bool is_open = true;
      for (const Side side : {Side::client, Side::server}) {
        if (is_open && polled[2 + 2 * i + static_cast<std::size_t>(side)].revents != 0) {
          is_open = forward(pairs[i], side);
        }
      }
      if (is_open) kept.push_back(pairs[i]);
      if (is_open) continue;
      for (const int socket : pairs[i].sockets) close(socket);
    }
    pairs = std::move(kept);
    if (polled[1].revents == 0) continue;
    if (const auto pair = accept_client()) pairs.push_back(*pair);
  }
  for (const Pair& pair : pairs) {
    for (const int socket : pair.sockets) close(socket);
  }
}

}  // namespace byre
