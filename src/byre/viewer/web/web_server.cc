#include "byre/viewer/web/web_server.h"

#include "byre/base/background_thread.h"
#include "byre/input_error.h"
#include "byre/viewer/web/web_connection.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

namespace byre {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr auto kPauseAfterFailure = std::chrono::milliseconds(200);
constexpr int kMaxWaiting = 512;  // length of the kernel's queue of connections

tcp::endpoint endpoint_of(const WebServerOptions& options) {
  error_code error;
  const std::string& name = options.address;
  const asio::ip::address address = asio::ip::make_address(name == "localhost" ? "127.0.0.1" : name, error);
  if (error) throw InputError(name, "is not an IP address", "give an address of this machine, or 0.0.0.0 for all");
  return {address, static_cast<std::uint16_t>(options.port)};
}

[[noreturn]] void refuse_to_listen(const WebServerOptions& options, const error_code& error) {
  const std::string place = options.address + " port " + std::to_string(options.port);
  if (error == asio::error::address_in_use) {
    throw InputError(place, "is in use", "stop the other program, or choose another port; 0: any free port");
  }
  if (error == asio::error::access_denied) {
    throw InputError(place, "needs privileges", "choose a port of at least 1024");
  }
  throw InputError(place, "cannot be used for listening: " + error.message(), "give an address of this machine");
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
  Core(const WebServerOptions& options, std::unique_ptr<WebSite> site, std::shared_ptr<LiveTopics> topics)
      : service_{std::move(site), std::move(topics), access_to(options.address), make_token(), {}},
        limits_(options.limits),
        end_of_descriptors_(end_of_descriptors(limits_)),
        table_(limits_),
        rate_(limits_, std::chrono::steady_clock::now()),
        acceptor_(listen(context_, options)),
        port_(acceptor_.local_endpoint().port()),
        urls_(urls_of(acceptor_.local_endpoint(), service_.access.token)) {
    accept();
    thread_ = std::thread([this] {
      lower_thread_priority();
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
      service_.site->refresh();
      service_.notify_listeners();
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
        // With too many open files, retrying immediately would only burn processor time.
        accept_after(kPauseAfterFailure);
        return;
      }
      rate_.count(std::chrono::steady_clock::now());
      start(std::move(socket));
      accept();
    });
  }

  void accept_after(std::chrono::milliseconds pause) {
    pause_.expires_after(pause);
    pause_.async_wait([this](error_code error) {
      if (!error) accept();
    });
  }

  void start(tcp::socket&& socket) {
    if (socket.native_handle() >= end_of_descriptors_) return;  // closes the socket
    error_code error;
    const tcp::endpoint peer = socket.remote_endpoint(error);
    if (error) return;  // already disconnected
    const ConnectionTable::Admission admission = table_.open(peer.address().to_string());
    const auto connection = std::make_shared<WebConnection>(
        std::move(socket), std::make_unique<ConnectionSlot>(table_, admission.id), service_);
    connections_[admission.id] = connection;
    connection->start(limits_.request_timeout);
    if (admission.to_close) close(*admission.to_close);
    std::erase_if(connections_, [](const auto& each) { return each.second.expired(); });
  }

  void close(ConnectionTable::Id id) {
    const auto found = connections_.find(id);
    if (found == connections_.end()) return;
    if (const std::shared_ptr<WebConnection> connection = found->second.lock()) connection->close();
  }

  WebService service_;  // used by the server's thread only

  // Constant after construction.
  WebLimits limits_;
  int end_of_descriptors_;

  // Owned by the server's thread. Queued operations use the members above, so the context is destroyed first.
  ConnectionTable table_;
  AcceptLimiter rate_;
  std::map<ConnectionTable::Id, std::weak_ptr<WebConnection>> connections_;
  asio::io_context context_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer pause_{context_};

  // Constant after construction.
  int port_;
  std::vector<std::string> urls_;
  std::thread thread_;
};

WebServer::WebServer(const WebServerOptions& options, std::unique_ptr<WebSite> site, std::shared_ptr<LiveTopics> topics)
    : core_(std::make_unique<Core>(options, std::move(site), std::move(topics))) {}

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
