#pragma once

#include <cstdint>
#include <map>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

namespace byre {

// What a browser does, for tests: waits for each answer.
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

  Answer get(const std::string& target, const Headers& headers = {}) const { return ask("GET", target, "", headers); }
  Answer post(const std::string& target, const std::string& body) const { return ask("POST", target, body, {}); }

  Answer ask(const std::string& method, const std::string& target, const std::string& body,
             const Headers& headers) const {
    namespace http = boost::beast::http;
    boost::asio::io_context context;
    boost::asio::ip::tcp::socket socket = connected(context, port_);
    http::request<http::string_body> request(http::string_to_verb(method), target, 11, body);
    request.set(http::field::host, "localhost:" + std::to_string(port_));
    for (const auto& [name, value] : headers) request.set(name, value);
    request.prepare_payload();
    http::write(socket, request);
    boost::beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(socket, buffer, response);
    return {static_cast<int>(response.result_int()), std::string(response[http::field::content_type]), response.body()};
  }

  static boost::asio::ip::tcp::socket connected(boost::asio::io_context& context, std::uint16_t port) {
    boost::asio::ip::tcp::socket socket(context);
    socket.connect({boost::asio::ip::make_address("127.0.0.1"), port});
    return socket;
  }

 private:
  std::uint16_t port_;
};

// A page that listens. Throws boost::system::system_error when it is refused, and when the connection ends.
class LiveClient {
 public:
  // headers: those of its request, beside what a WebSocket needs
  explicit LiveClient(int port, const std::string& target = "/live", const WebClient::Headers& headers = {})
      : stream_(WebClient::connected(context_, static_cast<std::uint16_t>(port))) {
    namespace websocket = boost::beast::websocket;
    stream_.set_option(websocket::stream_base::decorator([headers](websocket::request_type& request) {
      for (const auto& [name, value] : headers) request.set(name, value);
    }));
    websocket::response_type response;
    stream_.handshake(response, "localhost:" + std::to_string(port), target);
    protocol_ = std::string(response[boost::beast::http::field::sec_websocket_protocol]);
  }

  const std::string& protocol() const { return protocol_; }  // sub-protocol that the server chose

  void say(const std::string& bytes, bool is_binary = false) {
    stream_.binary(is_binary);
    stream_.write(boost::asio::buffer(bytes));
  }

  struct Message {
    std::string bytes;
    bool is_binary = false;

    nlohmann::json json() const { return nlohmann::json::parse(bytes); }
  };

  Message next() {
    boost::beast::flat_buffer buffer;
    stream_.read(buffer);
    return {boost::beast::buffers_to_string(buffer.data()), stream_.got_binary()};
  }

 private:
  boost::asio::io_context context_;
  boost::beast::websocket::stream<boost::asio::ip::tcp::socket> stream_;
  std::string protocol_;
};

}  // namespace byre
