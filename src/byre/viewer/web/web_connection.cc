#include "byre/viewer/web/web_connection.h"

#include "byre/input_error.h"
#include "byre/viewer/web/foxglove_client.h"

#include <array>

namespace byre {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::asio::ip::tcp;
using boost::system::error_code;
using Request = WebUpgrade;
using Response = http::response<http::string_body>;

constexpr auto kIdleTime = std::chrono::seconds(30);
constexpr std::uint32_t kMaxHeadBytes = 8 << 10;
constexpr std::size_t kMaxRequestBytes = 1 << 20;
constexpr auto kPathOfMessages = "/live";

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

// Headers forbid loading from other servers, and embedding in other pages.
Response finished(const WebResponse& answer, const Request& request) {
  Response response(static_cast<http::status>(answer.status), request.version());
  response.set(http::field::content_type, answer.content_type);
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Content-Security-Policy",
               "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src 'self' blob: data:; "
               "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
  response.keep_alive(request.keep_alive());
  response.body() = answer.body;
  response.prepare_payload();
  return response;
}

WebResponse answer(WebSite& site, const Request& request) {
  if (request.method() != http::verb::get && request.method() != http::verb::post) {
    return problem_response(405, "only GET and POST are supported");
  }
  const auto method = request.method() == http::verb::get ? WebRequest::Method::get : WebRequest::Method::post;
  try {
    return site.answer({method, std::string(path_of(view(request.target()))), request.body()});
  } catch (const InputError& error) {
    return problem_response(400, error.what());
  } catch (const std::exception& error) {
    return problem_response(500, error.what());
  }
}

WebResponse refused(int status, std::string_view reason) {
  return {status, "text/plain; charset=utf-8", std::string(reason) + "\n"};
}

// Messages of a site to an open page. Messages from the page are ignored.
class PageFeed : public WebFeed {
 public:
  explicit PageFeed(WebSite& site) : site_(site) {}
  std::optional<WebMessage> next() override { return site_.next_message(progress_); }

 private:
  WebSite& site_;
  ListenerProgress progress_;
};

}  // namespace

void WebListener::start(const WebUpgrade& request, std::string_view protocol) {
  socket_.accept(request, protocol, [self = shared_from_this()](bool is_open) {
    if (!is_open) return;
    self->is_open_ = true;
    self->read();
    self->send();
  });
}

void WebListener::notify(const std::vector<LiveMessage>& messages) {
  if (!is_open_) return;
  for (const LiveMessage& message : messages) feed_->offer(message);
  send();
}

void WebListener::send() {
  if (!is_open_ || is_sending_) return;
  std::optional<WebMessage> message = feed_->next();
  if (!message) return;
  is_sending_ = true;
  message_ = std::move(*message);
  const auto rest = message_.rest ? std::span(*message_.rest) : std::span<const std::byte>();
  socket_.write({message_.bytes, message_.is_binary}, rest, [self = shared_from_this()](bool is_open) {
    self->is_sending_ = false;
    self->is_open_ = self->is_open_ && is_open;
    self->send();
  });
}

// Reading also detects a closed connection.
void WebListener::read() {
  socket_.read([self = shared_from_this()](const WebSocketMessage* message) {
    if (message != nullptr && self->feed_->receive(message->bytes, message->is_binary)) {
      self->send();
      return self->read();
    }
    self->is_open_ = false;
    if (message != nullptr) self->socket_.close();
  });
}

// Largest message from a client: a list of subscriptions.
constexpr std::size_t kMaxClientMessageBytes = 64 << 10;

void WebSocket::accept(const WebUpgrade& request, std::string_view protocol, Done done) {
  stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
  stream_.set_option(
      websocket::stream_base::decorator([protocol = std::string(protocol)](websocket::response_type& response) {
        if (!protocol.empty()) response.set(beast::http::field::sec_websocket_protocol, protocol);
      }));
  stream_.read_message_max(kMaxClientMessageBytes);
  stream_.async_accept(request, [done = std::move(done)](error_code error) { done(!error); });
}

void WebSocket::write(const WebSocketMessage& head, std::span<const std::byte> rest, Done done) {
  stream_.binary(head.is_binary);
  const std::array<asio::const_buffer, 2> buffers = {asio::buffer(head.bytes), asio::buffer(rest.data(), rest.size())};
  stream_.async_write(buffers, [done = std::move(done)](error_code error, std::size_t) { done(!error); });
}

void WebSocket::read(Received received) {
  received_.clear();
  stream_.async_read(received_, [this, received = std::move(received)](error_code error, std::size_t) {
    if (error) {
      received(nullptr);
      return;
    }
    const auto bytes = received_.cdata();
    const WebSocketMessage message{{static_cast<const char*>(bytes.data()), bytes.size()}, stream_.got_binary()};
    received(&message);
  });
}

void WebSocket::close() {
  beast::get_lowest_layer(stream_).close();
}

void WebService::notify_listeners() {
  const std::vector<LiveMessage> messages = topics ? topics->take() : std::vector<LiveMessage>();
  std::erase_if(listeners, [](const std::weak_ptr<WebListener>& each) { return each.expired(); });
  for (const std::weak_ptr<WebListener>& each : listeners) each.lock()->notify(messages);
}

void WebConnection::read_head(std::chrono::milliseconds request_timeout) {
  parser_.emplace();
  parser_->header_limit(kMaxHeadBytes);
  parser_->body_limit(kMaxRequestBytes);
  stream_.expires_after(request_timeout);
  http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->check_access();
  });
}

// Foxglove sub-protocol requested and supported; empty: none.
std::string_view WebConnection::protocol_of(const Request& request) const {
  if (!service_.topics || !websocket::is_upgrade(request)) return {};
  return foxglove_protocol(view(request[http::field::sec_websocket_protocol]));
}

void WebConnection::check_access() {
  const Request& request = parser_->get();
  const WebOrigin origin = {view(request[http::field::host]), view(request[http::field::origin]),
                            view(request.target()), !protocol_of(request).empty()};
  if (const std::string_view reason = rejection_reason(service_.access, origin); !reason.empty()) {
    respond(refused(403, reason), is_accepted_);
    return;
  }
  if (!is_accepted_ && !slot_->accept()) {
    respond(refused(503, "too many pages are open"), false);
    return;
  }
  is_accepted_ = true;
  stream_.expires_after(kIdleTime);
  http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->answer_request();
  });
}

void WebConnection::answer_request() {
  const Request& request = parser_->get();
  const std::string_view protocol = protocol_of(request);
  const bool is_page = websocket::is_upgrade(request) && path_of(view(request.target())) == kPathOfMessages;
  if (protocol.empty() && !is_page) {
    respond(answer(*service_.site, request), true);
    return;
  }
  stream_.expires_never();
  tcp::socket socket = stream_.release_socket();
  std::unique_ptr<WebFeed> feed;
  if (protocol.empty()) {
    feed = std::make_unique<PageFeed>(*service_.site);
  } else {
    feed = std::make_unique<FoxgloveClient>(*service_.topics, service_.session);
  }
  const auto listener = std::make_shared<WebListener>(std::move(socket), std::move(slot_), std::move(feed));
  service_.listeners.push_back(listener);
  listener->start(request, protocol);
}

void WebConnection::respond(const WebResponse& response, bool may_keep_alive) {
  const Request& request = parser_->get();
  response_ = finished(response, request);
  // The rest of a rejected request would be parsed as the next request.
  if (!may_keep_alive || !parser_->is_done()) response_.keep_alive(false);
  stream_.expires_after(kIdleTime);
  http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    if (self->response_.need_eof()) {
      self->end();
    } else {
      self->read_head(kIdleTime);
    }
  });
}

void WebConnection::end() {
  error_code ignored;
  stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
}

}  // namespace byre
