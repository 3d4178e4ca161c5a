#include "byre/viewer/web/web_client_scene.h"

#include <boost/beast/http.hpp>

namespace byre {

namespace asio = boost::asio;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

WebClient::Answer WebClient::request(const std::string& method, const std::string& target, const std::string& body,
                                     const Headers& headers) const {
  asio::io_context context;
  asio::ip::tcp::socket socket = connected(context, port_);
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

asio::ip::tcp::socket WebClient::connected(asio::io_context& context, std::uint16_t port) {
  asio::ip::tcp::socket socket(context);
  socket.connect({asio::ip::make_address("127.0.0.1"), port});
  return socket;
}

LiveClient::LiveClient(int port, const std::string& target, const WebClient::Headers& headers)
    : stream_(WebClient::connected(context_, static_cast<std::uint16_t>(port))) {
  stream_.set_option(websocket::stream_base::decorator([headers](websocket::request_type& request) {
    for (const auto& [name, value] : headers) request.set(name, value);
  }));
  websocket::response_type response;
  stream_.handshake(response, "localhost:" + std::to_string(port), target);
  protocol_ = std::string(response[http::field::sec_websocket_protocol]);
}

void LiveClient::send(const std::string& bytes, bool is_binary) {
  stream_.binary(is_binary);
  stream_.write(asio::buffer(bytes));
}

LiveClient::Message LiveClient::next() {
  boost::beast::flat_buffer buffer;
  stream_.read(buffer);
  return {boost::beast::buffers_to_string(buffer.data()), stream_.got_binary()};
}

}  // namespace byre
