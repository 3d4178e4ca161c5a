#pragma once

#include <cstdint>
#include <map>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

namespace byre {

// Blocking HTTP client for tests.
class WebClient {
 public:
  struct Answer {
    int status = 0;
    std::string content_type;
    std::string body;

    nlohmann::json json() const { return nlohmann::json::parse(body); }
  };
  using Headers = std::map<std::string, std::string>;

  explicit WebClient(int port) : port_(static_cast<std::uint16_t>(port)) {}

  Answer get(const std::string& target, const Headers& headers = {}) const {
    return request("GET", target, "", headers);
  }
  Answer post(const std::string& target, const std::string& body) const { return request("POST", target, body, {}); }

  Answer request(const std::string& method, const std::string& target, const std::string& body,
                 const Headers& headers) const;

  static boost::asio::ip::tcp::socket connected(boost::asio::io_context& context, std::uint16_t port);

 private:
  std::uint16_t port_;
};

// WebSocket client. Throws boost::system::system_error if rejected or disconnected.
class LiveClient {
 public:
  // headers: additional request headers
  explicit LiveClient(int port, const std::string& target = "/live", const WebClient::Headers& headers = {});

  const std::string& protocol() const { return protocol_; }  // sub-protocol chosen by the server

  void send(const std::string& bytes, bool is_binary = false);

  struct Message {
    std::string bytes;
    bool is_binary = false;

    nlohmann::json json() const { return nlohmann::json::parse(bytes); }
  };

  Message next();

 private:
  boost::asio::io_context context_;
  boost::beast::websocket::stream<boost::asio::ip::tcp::socket> stream_;
  std::string protocol_;
};

}  // namespace byre
