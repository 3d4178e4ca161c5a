#include "byre/registry/robot_link.h"

#include "byre/base/background_thread.h"
#include "byre/base/output_file.h"
#include "byre/base/printable.h"
#include "byre/input_error.h"
#include "byre/map/map_upkeep.h"
#include "byre/registry/connection.h"
#include "byre/registry/versions.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <system_error>
#include <thread>
#include <vector>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Seconds = std::chrono::duration<double>;

constexpr const char* kSession = ".session";
constexpr const char* kMap = ".byre";
constexpr const char* kLastSession = "last.session";  // not queued under this name

struct Queue {
  std::vector<fs::path> sessions;  // the oldest first, by name
  std::uintmax_t bytes = 0;
};

Queue queue_in(const fs::path& folder) {
  Queue queue;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::error_code ignored;  // a file may be gone meanwhile
    if (entry->path().extension() != kSession || entry->path().filename() == kLastSession) continue;
    const std::uintmax_t bytes = entry->file_size(ignored);
    if (ignored) continue;
    queue.sessions.push_back(entry->path());
    queue.bytes += bytes;
  }
  std::ranges::sort(queue.sessions);
  return queue;
}

// Empty for a file that is no map.
std::string id_of(const fs::path& map) {
  try {
    return to_text(map_id(map));
  } catch (const InputError&) {
    return "";
  }
}

}  // namespace

struct RobotLink::Impl {
  explicit Impl(const RobotLinkOptions& given) : options(given) {}
  ~Impl();

  void run(const std::stop_token& stop);
  bool exchange(const std::stop_token& stop);
  void send_sessions(Connection& opened, std::int64_t site, const std::stop_token& stop);
  void fetch(Connection& opened, std::int64_t site);
  void remove_versions_but(const std::string& kept) const;
  void report(Connection& opened);
  void note_queue();
  fs::path file_of(const std::string& id) const { return options.folder / (id + kMap); }
  // Calls change(state).
  void change(const auto& change_of) {
    const std::lock_guard lock(mutex);
    change_of(state);
  }

  // Makes a connection known to the destructor, which interrupts it.
  class Use {
   public:
    Use(Impl& impl, Connection& opened) : impl_(impl) { set(&opened); }
    ~Use() { set(nullptr); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    void set(Connection* opened) {
      const std::lock_guard lock(impl_.mutex);
      impl_.connection = opened;
    }

    Impl& impl_;
  };

  const RobotLinkOptions options;
  std::mutex mutex;  // guards the members up to the thread
  std::condition_variable_any woken;
  bool is_woken = false;
  Connection* connection = nullptr;  // while it is used
  RobotLinkState state;
  std::jthread thread;  // the last member: it uses the others
};

RobotLink::Impl::~Impl() {
  thread.request_stop();
  const std::lock_guard lock(mutex);
  if (connection != nullptr) connection->interrupt();
}

void RobotLink::Impl::note_queue() {
  const Queue queue = queue_in(options.folder);
  change([&](RobotLinkState& now) {
    now.waiting = static_cast<int>(queue.sessions.size());
    now.waiting_bytes = queue.bytes;
  });
}

void RobotLink::Impl::run(const std::stop_token& stop) {
  constexpr double kFirst = 1.0, kLongest = 600.0;  // seconds after failures
  lower_thread_priority();
  double after_failure = std::min(kFirst, options.interval_s);
  while (!stop.stop_requested()) {
    const bool is_done = exchange(stop);
    const Seconds wait(is_done ? options.interval_s : after_failure);
    after_failure = is_done ? std::min(kFirst, options.interval_s) : std::min(2.0 * after_failure, kLongest);
    std::unique_lock lock(mutex);
    woken.wait_for(lock, stop, wait, [this] { return is_woken; });
    is_woken = false;
  }
}

// Whether all was done.
bool RobotLink::Impl::exchange(const std::stop_token& stop) {
  std::string fault;
  // Faults of one task do not stop the other, unless the connection breaks.
  const auto attempt = [&](auto task) {
    try {
      task();
    } catch (const InputError& error) {
      fault = error.what();
    }
  };
  try {
    Connection opened = open_registry(options.database);
    opened.stop_by(stop);
    const Use use(*this, opened);
    const std::int64_t site = site_number(opened, options.site);
    change([](RobotLinkState& now) { now.contact = std::chrono::system_clock::now(); });
    attempt([&] { send_sessions(opened, site, stop); });
    if (!stop.stop_requested()) attempt([&] { fetch(opened, site); });
    if (!stop.stop_requested()) attempt([&] { report(opened); });
  } catch (const std::exception& error) {
    fault = error.what();
  }
  note_queue();
  change([&](RobotLinkState& now) { now.fault = fault; });
  return fault.empty();
}

// A session that the server refuses stays, and the others are sent.
void RobotLink::Impl::send_sessions(Connection& opened, std::int64_t site, const std::stop_token& stop) {
  std::optional<InputError> refusal;
  for (const fs::path& session : queue_in(options.folder).sessions) {
    if (stop.stop_requested()) return;
    try {
      push_file(opened, site, session, "");
      fs::remove(session);
    } catch (const InputError& error) {
      refusal.emplace(error);
    }
    note_queue();
  }
  if (refusal) throw InputError(*refusal);
}

void RobotLink::Impl::fetch(Connection& opened, std::int64_t site) {
  const std::string accepted = accepted_version(opened, site).value_or("");
  bool is_new = false;
  change([&](RobotLinkState& now) {
    now.accepted = accepted;
    is_new = !accepted.empty() && accepted != now.present;
    if (!is_new || now.fetched != accepted) now.fetched.clear();
  });
  remove_versions_but(is_new ? accepted : "");
  if (!is_new) return;
  try {
    pull_map(opened, site, accepted, file_of(accepted));
  } catch (const InputError& error) {
    change([&](RobotLinkState& now) {
      now.refused = accepted;
      now.reason = error.what();
    });
    throw;
  }
  change([&](RobotLinkState& now) {
    if (now.fetched == accepted || now.present == accepted) return;
    now.fetched = accepted;
    if (now.refused == accepted) now.refused = now.reason = "";  // an earlier transfer failed
  });
}

void RobotLink::Impl::remove_versions_but(const std::string& kept) const {
  std::error_code error;
  fs::directory_iterator entry(options.folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::error_code ignored;
    const fs::path path = entry->path();
    if (path.extension() == kMap && path.stem() != kept) fs::remove(path, ignored);
  }
}

void RobotLink::Impl::report(Connection& opened) {
  constexpr std::size_t kMaxReason = 1000;  // bytes; limit of the schema
  note_queue();
  RobotLinkState reported;
  change([&](const RobotLinkState& now) { reported = now; });
  opened.run(
      "UPDATE byre.robot SET seen_at = now(), runs = $1, refused = $2, reason = $3, waiting = $4 WHERE account = "
      "current_user",
      {reported.present, reported.refused, printable(reported.reason, kMaxReason), reported.waiting});
}

RobotLink::RobotLink(const RobotLinkOptions& options) : impl_(std::make_unique<Impl>(options)) {
  note_present();
  impl_->note_queue();
}

RobotLink::~RobotLink() = default;

void RobotLink::start() {
  if (impl_->thread.joinable()) return;
  std::error_code error;  // writers report it
  fs::create_directories(impl_->options.folder, error);
  impl_->thread = std::jthread([impl = impl_.get()](const std::stop_token& stop) { impl->run(stop); });
}

fs::path RobotLink::last_session() const {
  return impl_->options.folder / kLastSession;
}

bool RobotLink::queue_last_session(const std::string& name) {
  const fs::path& folder = impl_->options.folder;
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(last_session(), error);
  const bool has_space = !error && queue_in(folder).bytes + bytes <= impl_->options.max_bytes;
  if (has_space) {
    fs::path path = folder / (name + kSession);
    for (int i = 2; fs::exists(path, error); ++i) path = folder / (name + "_" + std::to_string(i) + kSession);
    link_or_copy(last_session(), path);
  }
  impl_->note_queue();
  impl_->change([&](RobotLinkState& now) { now.left_out += has_space ? 0 : 1; });
  const std::lock_guard lock(impl_->mutex);
  impl_->is_woken = true;
  impl_->woken.notify_all();
  return has_space;
}

std::optional<fs::path> RobotLink::fetched() const {
  const std::string id = state().fetched;
  return id.empty() ? std::nullopt : std::optional(impl_->file_of(id));
}

void RobotLink::refuse(const fs::path& version, const std::string& reason) {
  impl_->change([&](RobotLinkState& now) {
    now.refused = version.stem().string();
    now.reason = reason;
  });
}

void RobotLink::note_present() {
  const std::string present = id_of(impl_->options.map);
  impl_->change([&](RobotLinkState& now) {
    now.present = present;
    if (now.fetched == present) now.fetched.clear();
    if (now.refused == present) now.refused = now.reason = "";
  });
}

RobotLinkState RobotLink::state() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->state;
}

}  // namespace byre
