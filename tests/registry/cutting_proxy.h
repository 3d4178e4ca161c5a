#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace byre {

// TCP proxy before a PostgreSQL server, which counts the bytes of both sides and cuts a connection at one of them.
class CuttingProxy {
 public:
  enum class Side { client, server };

  // Cut before the byte of this number that the side sends.
  struct Cut {
    Side side = Side::client;
    std::size_t byte = 0;
  };

  // socket: of the server.
  explicit CuttingProxy(std::filesystem::path socket);
  ~CuttingProxy();
  CuttingProxy(const CuttingProxy&) = delete;
  CuttingProxy& operator=(const CuttingProxy&) = delete;

  std::string uri(const std::string& database, const std::string& account) const;

  // Counts from zero; empty: cuts nothing.
  void begin(std::optional<Cut> cut);
  bool has_cut() const;
  // While silent, all bytes are lost, as in a network without a route.
  void be_silent(bool is_silent);
  // Cuts before and in the middle of each message since begin(): what one side sends until the other answers.
  std::vector<Cut> places_to_cut() const;

 private:
  struct Pair {
    std::array<int, 2> sockets{-1, -1};  // by side
  };

  void serve();
  std::optional<Pair> accept_client() const;
  // Forwards what a side sent. False if the pair is to be closed.
  bool forward(const Pair& pair, Side from);

  std::filesystem::path socket_;
  int listener_ = -1;
  int port_ = 0;
  std::array<int, 2> wake_{-1, -1};  // pipe that ends the thread

  mutable std::mutex mutex_;  // guards the next six members
  std::optional<Cut> cut_;
  bool has_cut_ = false;
  bool is_silent_ = false;
  std::array<std::size_t, 2> sent_{};  // bytes, by side
  std::optional<Side> speaker_;
  std::vector<Cut> messages_;  // first bytes

  std::jthread thread_;  // the last member: it uses the others
};

}  // namespace byre
