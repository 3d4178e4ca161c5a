#include "byre/viewer/web_server.h"

#include "byre/input_error.h"
#include "byre/viewer/web_access.h"
#include "byre/viewer/web_address.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <sys/resource.h>
#include <unistd.h>

namespace byre {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

constexpr auto kIdleTime = std::chrono::seconds(30);
constexpr auto kPauseAfterFailure = std::chrono::milliseconds(200);
constexpr std::uint32_t kMaxHeadBytes = 8 << 10;
constexpr std::size_t kMaxRequestBytes = 1 << 20;
constexpr int kMaxWaiting = 512;  // connections that the kernel keeps until they are let in
constexpr int kNiceness = 5;      // niceness of the server's thread: what else the program does comes first
constexpr std::size_t kMaxMessageBytes = 1 << 10;  // message from a page, which has nothing to say there
constexpr auto kPathOfMessages = "/live";

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

WebOrigin origin_of(const Request& request) {
  return {view(request[http::field::host]), view(request[http::field::origin]), view(request.target())};
}

// Nothing is asked of other servers, and no other page may show this one.
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
    return problem_response(405, "only GET and POST are known");
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

// The place of a connection among the guests, given back at the end of its life.
class Seat {
 public:
  Seat(WebGuests& guests, WebGuests::Id id) : guests_(guests), id_(id) {}
  ~Seat() { guests_.leave(id_); }
  Seat(const Seat&) = delete;
  Seat& operator=(const Seat&) = delete;

  bool introduce() { return guests_.introduce(id_); }

 private:
  WebGuests& guests_;
  WebGuests::Id id_;
};

// A WebSocket that tells what a site has to tell. Lives as long as an operation on it is under way.
class Listener : public std::enable_shared_from_this<Listener> {
 public:
  Listener(tcp::socket&& socket, std::unique_ptr<Seat> seat, WebSite& site)
      : seat_(std::move(seat)), stream_(std::move(socket)), site_(site) {}

  void start(const Request& request) {
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.read_message_max(kMaxMessageBytes);
    stream_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->is_open_ = true;
      self->read();
      self->tell();
    });
  }

  // Sends what is new, unless that is being done.
  void tell() {
    if (!is_open_ || is_sending_) return;
    std::optional<WebMessage> message = site_.next_message(progress_);
    if (!message) return;
    is_sending_ = true;
    message_ = std::move(*message);
    stream_.binary(message_.is_binary);
    stream_.async_write(asio::buffer(message_.bytes), [self = shared_from_this()](error_code error, std::size_t) {
      self->is_sending_ = false;
      if (error) {
        self->is_open_ = false;
      } else {
        self->tell();
      }
    });
  }

  bool is_open() const { return is_open_; }

 private:
  // What it is sent is dropped; reading is how a closed connection is noticed.
  void read() {
    stream_.async_read(received_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) {
        self->is_open_ = false;
        return;
      }
      self->received_.clear();
      self->read();
    });
  }

  // Owned by the server's thread.
  std::unique_ptr<Seat> seat_;
  websocket::stream<beast::tcp_stream> stream_;
  WebSite& site_;
  ListenerProgress progress_;
  WebMessage message_;  // message that is being sent
  beast::flat_buffer received_;
  bool is_open_ = false;
  bool is_sending_ = false;
};

using Listeners = std::vector<std::weak_ptr<Listener>>;

// Requests of one HTTP connection, one after the other, until one of them makes a listener of it. Of a stranger nothing
// is read but the head of one request, in the time it has for that; if it is refused, the connection ends.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket&& socket, std::unique_ptr<Seat> seat, WebSite& site, const WebAccess& access,
             Listeners& listeners)
      : seat_(std::move(seat)), stream_(std::move(socket)), site_(site), access_(access), listeners_(listeners) {}

  void welcome(std::chrono::milliseconds patience) { read_head(patience); }

  void close() { stream_.close(); }

 private:
  void read_head(std::chrono::milliseconds patience) {
    parser_.emplace();
    parser_->header_limit(kMaxHeadBytes);
    parser_->body_limit(kMaxRequestBytes);
    stream_.expires_after(patience);
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->judge();
    });
  }

  void judge() {
    if (const std::string_view reason = refusal(access_, origin_of(parser_->get())); !reason.empty()) {
      respond(refused(403, reason), is_known_);
      return;
    }
    if (!is_known_ && !seat_->introduce()) {
      respond(refused(503, "too many pages are open"), false);
      return;
    }
    is_known_ = true;
    stream_.expires_after(kIdleTime);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->answer_request();
    });
  }

  void answer_request() {
    const Request& request = parser_->get();
    if (websocket::is_upgrade(request) && path_of(view(request.target())) == kPathOfMessages) {
      listen(request);
    } else {
      respond(answer(site_, request), true);
    }
  }

  void listen(const Request& request) {
    stream_.expires_never();
    const auto listener = std::make_shared<Listener>(stream_.release_socket(), std::move(seat_), site_);
    listeners_.push_back(listener);
    listener->start(request);
  }

  void respond(const WebResponse& response, bool may_go_on) {
    const Request& request = parser_->get();
    response_ = finished(response, request);
    // What is left of a request that was refused would be taken for the next one.
    if (!may_go_on || !parser_->is_done()) response_.keep_alive(false);
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

  void end() {
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  // Owned by the server's thread.
  std::unique_ptr<Seat> seat_;
  beast::tcp_stream stream_;
  WebSite& site_;
  const WebAccess& access_;
  Listeners& listeners_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;  // parser of one request
  Response response_;                                              // response that is being sent
  bool is_known_ = false;                                          // whether it has asked for what it may have
};

tcp::endpoint endpoint_of(const WebServerOptions& options) {
  error_code error;
  const std::string& name = options.address;
  const asio::ip::address address = asio::ip::make_address(name == "localhost" ? "127.0.0.1" : name, error);
  if (error) throw InputError(name, "is no IP address", "name one of this machine's, or 0.0.0.0 for all of them");
  return {address, static_cast<std::uint16_t>(options.port)};
}

[[noreturn]] void refuse_to_listen(const WebServerOptions& options, const error_code& error) {
  const std::string place = options.address + " port " + std::to_string(options.port);
  if (error == asio::error::address_in_use) {
    throw InputError(place, "is in use", "end the other program, or choose another port; 0 takes one that is free");
  }
  if (error == asio::error::access_denied) {
    throw InputError(place, "may not be used", "choose a port from 1024 on");
  }
  throw InputError(place, "cannot be listened on: " + error.message(), "name an address of this machine");
}

tcp::acceptor listen(asio::io_context& context, const WebServerOptions& options) {
  const tcp::endpoint endpoint = endpoint_of(options);
  tcp::acceptor acceptor(context);
  error_code error;
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(kMaxWaiting, error);
  if (error) refuse_to_listen(options, error);
  return acceptor;
}

std::string url_of(const std::string& address, int port, const std::string& token) {
  const std::string host = address.find(':') == std::string::npos ? address : "[" + address + "]";
  const std::string page = "http://" + host + ":" + std::to_string(port) + "/";
  return token.empty() ? page : page + "?token=" + token;
}

std::vector<std::string> urls_of(const tcp::endpoint& bound, const std::string& token) {
  std::vector<std::string> urls;
  for (const std::string& address : reachable_addresses(bound.address().to_string())) {
    urls.push_back(url_of(address, bound.port(), token));
  }
  return urls;
}

}  // namespace

class WebServer::Core {
 public:
  Core(const WebServerOptions& options, std::unique_ptr<WebSite> site)
      : site_(std::move(site)),
        access_(access_to(options.address)),
        limits_(options.limits),
        end_of_descriptors_(end_of_descriptors(limits_)),
        guests_(limits_),
        rate_(limits_, std::chrono::steady_clock::now()),
        acceptor_(listen(context_, options)),
        port_(acceptor_.local_endpoint().port()),
        urls_(urls_of(acceptor_.local_endpoint(), access_.token)) {
    accept();
    thread_ = std::thread([this] {
      const auto self = static_cast<id_t>(gettid());
      setpriority(PRIO_PROCESS, self, getpriority(PRIO_PROCESS, self) + kNiceness);
      context_.run();
    });
  }

  ~Core() {
    context_.stop();
    thread_.join();
  }

  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  void wake() {
    asio::post(context_, [this] {
      site_->refresh();
      tell_listeners();
    });
  }

  const std::vector<std::string>& urls() const { return urls_; }
  int port() const { return port_; }

 private:
  void accept() {
    const std::chrono::milliseconds wait = rate_.wait(std::chrono::steady_clock::now());
    if (wait.count() > 0) {
      accept_after(wait);
      return;
    }
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      if (error) {
        // Where there are too many open files, asking again at once would only take up the processor.
        accept_after(kPauseAfterFailure);
        return;
      }
      rate_.count(std::chrono::steady_clock::now());
      welcome(std::move(socket));
      accept();
    });
  }

  void accept_after(std::chrono::milliseconds pause) {
    pause_.expires_after(pause);
    pause_.async_wait([this](error_code error) {
      if (!error) accept();
    });
  }

  void welcome(tcp::socket&& socket) {
    if (socket.native_handle() >= end_of_descriptors_) return;  // closes the socket
    error_code error;
    const tcp::endpoint peer = socket.remote_endpoint(error);
    if (error) return;  // it is gone again
    const WebGuests::Arrival arrival = guests_.arrive(peer.address().to_string());
    const auto connection = std::make_shared<Connection>(std::move(socket), std::make_unique<Seat>(guests_, arrival.id),
                                                         *site_, access_, listeners_);
    connections_[arrival.id] = connection;
    connection->welcome(limits_.patience);
    if (arrival.to_close) close(*arrival.to_close);
    std::erase_if(connections_, [](const auto& each) { return each.second.expired(); });
  }

  void close(WebGuests::Id id) {
    const auto found = connections_.find(id);
    if (found == connections_.end()) return;
    if (const std::shared_ptr<Connection> connection = found->second.lock()) connection->close();
  }

  void tell_listeners() {
    std::erase_if(listeners_, [](const std::weak_ptr<Listener>& listener) { return listener.expired(); });
    for (const std::weak_ptr<Listener>& listener : listeners_) listener.lock()->tell();
  }

  // Constant after construction; the site is used by the server's thread alone.
  std::unique_ptr<WebSite> site_;
  WebAccess access_;
  WebLimits limits_;
  int end_of_descriptors_;

  // Owned by the server's thread. What waits in the context uses what is above it, and goes before that.
  WebGuests guests_;
  ArrivalRate rate_;
  std::map<WebGuests::Id, std::weak_ptr<Connection>> connections_;
  Listeners listeners_;
  asio::io_context context_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer pause_{context_};

  // Constant after construction.
  int port_;
  std::vector<std::string> urls_;
  std::thread thread_;
};

WebServer::WebServer(const WebServerOptions& options, std::unique_ptr<WebSite> site)
    : core_(std::make_unique<Core>(options, std::move(site))) {}

WebServer::~WebServer() = default;

const std::vector<std::string>& WebServer::urls() const {
  return core_->urls();
}

int WebServer::port() const {
  return core_->port();
}

void WebServer::wake() {
  core_->wake();
}

}  // namespace byre
