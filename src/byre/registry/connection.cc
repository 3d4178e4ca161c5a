#include "byre/registry/connection.h"

#include "byre/base/binary_file.h"
#include "byre/base/data_file.h"
#include "byre/base/printable.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <dlfcn.h>
#include <fmt/format.h>
#include <libpq-fe.h>
#include <poll.h>
#include <sys/socket.h>

namespace byre {
namespace {

// Function of libpq, which is loaded at first use and stays loaded: with its dependencies (Kerberos, LDAP) it takes 5
// MB and 15 ms at the start of a program, of which most runs have no use.
void* libpq_function(const char* name) {
  static void* const library = dlopen("libpq.so.5", RTLD_LAZY | RTLD_LOCAL);
  void* const function = library == nullptr ? nullptr : dlsym(library, name);
  if (function != nullptr) return function;
  const char* const reason = dlerror();
  throw std::runtime_error(fmt::format("libpq.so.5 cannot be used: {} (install libpq5)", reason ? reason : name));
}
#define LIBPQ(function) reinterpret_cast<decltype(&::function)>(libpq_function(#function))

// First line of a message of libpq.
std::string first_line(const char* message) {
  const std::string_view text = message == nullptr ? "" : message;
  return printable(text.substr(0, text.find('\n')));
}

std::string field(const PGresult* result, int code) {
  const char* const text = LIBPQ(PQresultErrorField)(result, code);
  return text == nullptr ? "" : text;
}

constexpr const char* kUnreachable =
    "check --registry, registry.database or PGHOST, PGPORT, PGDATABASE, PGUSER, and that the server runs and admits "
    "the account";

// Clients for earlier schemas than this one cannot use the present one.
constexpr int kOldestClient = 2;

[[noreturn]] void refuse_newer(const Connection& connection, int schema) {
  throw InputError(connection.place(),
                   fmt::format("has schema {}, and this byre is made for schema {}", schema, kRegistrySchema),
                   "install a newer byre");
}

}  // namespace

Parameter::Parameter(const std::vector<std::string>& list) : value_("{") {
  for (const std::string& text : list) {
    if (value_->size() > 1) *value_ += ',';
    *value_ += '"';
    for (const char character : text) {
      if (character == '"' || character == '\\') *value_ += '\\';
      *value_ += character;
    }
    *value_ += '"';
  }
  *value_ += '}';
}

void Rows::Clear::operator()(pg_result* result) const {
  LIBPQ(PQclear)(result);
}

int Rows::size() const {
  return LIBPQ(PQntuples)(result_.get());
}

int Rows::columns() const {
  return LIBPQ(PQnfields)(result_.get());
}

int Rows::changed() const {
  return std::atoi(LIBPQ(PQcmdTuples)(result_.get()));
}

bool Rows::is_null(int row, int column) const {
  return LIBPQ(PQgetisnull)(result_.get(), row, column) != 0;
}

std::string Rows::text(int row, int column) const {
  return {LIBPQ(PQgetvalue)(result_.get(), row, column),
          static_cast<std::size_t>(LIBPQ(PQgetlength)(result_.get(), row, column))};
}

std::int64_t Rows::number(int row, int column) const {
  return std::atoll(LIBPQ(PQgetvalue)(result_.get(), row, column));
}

void Connection::Close::operator()(pg_conn* connection) const {
  LIBPQ(PQfinish)(connection);
}

Connection::Connection(const std::string& uri, std::optional<std::chrono::seconds> patience) : patience_(patience) {
  // Defaults first: parameters of the URI replace them. A cut network is noticed after 30 s.
  const std::array keys = {"connect_timeout",           "keepalives_idle",  "keepalives_interval",
                           "keepalives_count",          "tcp_user_timeout", "dbname",
                           "fallback_application_name", "client_encoding",  static_cast<const char*>(nullptr)};
  const std::string connect_timeout = std::to_string(patience ? patience->count() : 10);
  const std::array values = {
      std::getenv("PGCONNECT_TIMEOUT") != nullptr ? std::getenv("PGCONNECT_TIMEOUT") : connect_timeout.c_str(),
      "10",
      "5",
      "4",
      "30000",
      uri.c_str(),
      "byre",
      "UTF8",
      static_cast<const char*>(nullptr)};
  connection_.reset(LIBPQ(PQconnectdbParams)(keys.data(), values.data(), 1));
  const auto or_empty = [](const char* text) { return std::string(text == nullptr ? "" : text); };
  place_ = fmt::format("registry {}/{}", or_empty(LIBPQ(PQhost)(connection_.get())),
                       or_empty(LIBPQ(PQdb)(connection_.get())));
  require_connected();
  LIBPQ(PQsetNoticeProcessor)
  (
      connection_.get(), [](void*, const char*) {}, nullptr);
}

void Connection::require_connected() const {
  if (LIBPQ(PQstatus)(connection_.get()) == CONNECTION_OK) return;
  throw ConnectionLost(
      fmt::format("{}: {} ({})", place_, first_line(LIBPQ(PQerrorMessage)(connection_.get())), kUnreachable));
}

void Connection::reconnect() {
  LIBPQ(PQreset)(connection_.get());
  require_connected();
}

void Connection::interrupt() const {
  shutdown(LIBPQ(PQsocket)(connection_.get()), SHUT_RDWR);
}

Rows Connection::run(const char* statement, const std::vector<Parameter>& parameters) {
  return execute(statement, parameters, false);
}

std::optional<std::vector<std::byte>> Connection::bytes(const char* statement,
                                                        const std::vector<Parameter>& parameters) {
  const Rows rows = execute(statement, parameters, true);
  if (rows.size() == 0 || rows.is_null(0, 0)) return std::nullopt;
  const auto* const first = reinterpret_cast<const std::byte*>(LIBPQ(PQgetvalue)(rows.get(), 0, 0));
  return std::vector<std::byte>(first, first + LIBPQ(PQgetlength)(rows.get(), 0, 0));
}

Rows Connection::execute(const char* statement, const std::vector<Parameter>& parameters, bool is_binary) {
  std::vector<const char*> values;
  std::vector<int> sizes, formats;
  for (const Parameter& parameter : parameters) {
    values.push_back(parameter.data());
    sizes.push_back(parameter.size());
    formats.push_back(parameter.is_binary() ? 1 : 0);
  }
  Rows answer(nullptr);
  if (LIBPQ(PQsendQueryParams)(connection_.get(), statement, static_cast<int>(parameters.size()), nullptr,
                               values.data(), sizes.data(), formats.data(), is_binary ? 1 : 0) != 0) {
    await_answer();
    while (PGresult* const result = LIBPQ(PQgetResult)(connection_.get())) {
      answer = Rows(result);
      await_answer();
    }
  }
  require_success(answer);
  return answer;
}

// Returns once PQgetResult() does not wait for the server.
void Connection::await_answer() const {
  const auto end = std::chrono::steady_clock::now() + patience_.value_or(std::chrono::seconds(0));
  while (LIBPQ(PQisBusy)(connection_.get()) != 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    pollfd socket{LIBPQ(PQsocket)(connection_.get()), POLLIN, 0};
    const int ready =
        patience_ && left.count() <= 0 ? 0 : poll(&socket, 1, patience_ ? static_cast<int>(left.count()) : -1);
    if (ready == 0) {
      interrupt();  // no later statement waits for this answer
      throw ConnectionLost(fmt::format("{}: the connection broke: no answer within {} s", place_, patience_->count()));
    }
    if (ready > 0 && LIBPQ(PQconsumeInput)(connection_.get()) == 0) return;
  }
}

void Connection::run_script(const std::string& statements) {
  require_success(Rows(LIBPQ(PQexec)(connection_.get(), statements.c_str())));
}

void Connection::require_success(const Rows& answer) const {
  const PGresult* const failed = answer.get();
  const ExecStatusType status = LIBPQ(PQresultStatus)(failed);
  if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK) return;
  const std::string state = field(failed, PG_DIAG_SQLSTATE), kind = state.substr(0, 2);
  const std::string reason = field(failed, PG_DIAG_MESSAGE_PRIMARY), hint = field(failed, PG_DIAG_MESSAGE_HINT);
  if (LIBPQ(PQstatus)(connection_.get()) != CONNECTION_OK || kind == "08" || state == "57P01" || state == "57P02" ||
      state == "57P03") {
    throw ConnectionLost(
        fmt::format("{}: the connection broke: {}", place_, first_line(LIBPQ(PQerrorMessage)(connection_.get()))));
  }
  if (state == "3F000" || state == "42P01" || state == "42883") {
    throw InputError(place_, "is no registry of maps: " + reason, "make it one with byre registry init");
  }
  if (state == "42501") {
    const std::string account = LIBPQ(PQuser)(connection_.get());
    throw InputError(place_, reason + " for the account " + account, "use an account with the role that may do this");
  }
  if (state == "55P03") throw InputError(place_, "is in use by another client: " + reason, "try again");
  if (field(failed, PG_DIAG_CONSTRAINT_NAME) == "chunk_hash") {
    throw InputError(place_, "refuses a chunk whose bytes do not have its SHA-256", "push the file again");
  }
  if (kind == "53" || kind == "40") {  // a full disk, too many connections; a deadlock
    throw ConnectionLost(fmt::format("{}: {} (free disk space, memory or connections of the server)", place_, reason));
  }
  throw InputError(place_, reason.empty() ? first_line(LIBPQ(PQerrorMessage)(connection_.get())) : reason, hint);
}

bool Connection::wait_for_notification(std::chrono::milliseconds most) {
  const auto end = std::chrono::steady_clock::now() + most;
  while (true) {
    if (LIBPQ(PQconsumeInput)(connection_.get()) == 0) {
      throw ConnectionLost(fmt::format("{}: the connection broke", place_));
    }
    bool is_notified = false;
    while (PGnotify* const note = LIBPQ(PQnotifies)(connection_.get())) {
      LIBPQ(PQfreemem)(note);
      is_notified = true;
    }
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (is_notified || left.count() <= 0) return is_notified;
    pollfd socket{LIBPQ(PQsocket)(connection_.get()), POLLIN, 0};
    if (poll(&socket, 1, static_cast<int>(left.count())) < 0) return false;  // a signal
  }
}

Transaction::Transaction(Connection& connection) : connection_(connection) {
  connection_.run("BEGIN");
}

Transaction::~Transaction() {
  if (!is_open_) return;
  try {
    connection_.run("ROLLBACK");
  } catch (const std::exception&) {
    // The server rolls back when the connection ends.
  }
}

void Transaction::commit() {
  is_open_ = false;
  connection_.run("COMMIT");
}

void persist(Connection& connection, const std::function<void()>& action) {
  bool is_broken = false;
  for (const int wait_ms : {100, 400, 1000, 2000, 4000, 8000, 15000, 0}) {
    try {
      if (is_broken) connection.reconnect();
      return action();
    } catch (const ConnectionLost&) {
      if (wait_ms == 0 || connection.is_stopped()) throw;
      is_broken = true;
    }
    constexpr int kSlice = 100;  // milliseconds
    for (int waited = 0; waited < wait_ms && !connection.is_stopped(); waited += kSlice) poll(nullptr, 0, kSlice);
  }
}

int registry_schema(Connection& connection) {
  if (connection.run("SELECT to_regnamespace('byre')").is_null(0, 0)) return 0;
  return static_cast<int>(connection.run("SELECT coalesce(max(version), 0) FROM byre.schema_version").number(0, 0));
}

int migrate_registry(Connection& connection) {
  int before = -1;
  for (int schema = 1; schema <= kRegistrySchema; ++schema) {
    Transaction transaction(connection);
    connection.run("SELECT pg_advisory_xact_lock(hashtext('byre'))");  // one migration at a time
    const int present = registry_schema(connection);
    if (before < 0) before = present;
    if (present > kRegistrySchema) refuse_newer(connection, present);
    if (present >= schema) continue;
    const std::vector<std::byte> statements =
        read_file(find_data_file(fmt::format("registry/{}.sql", schema), "install the package byre-data"));
    connection.run_script({reinterpret_cast<const char*>(statements.data()), statements.size()});
    connection.run("INSERT INTO byre.schema_version (version, oldest_client) VALUES ($1, $2)",
                   {schema, std::min(schema, kOldestClient)});
    transaction.commit();
  }
  return before;
}

Connection open_registry(const std::string& uri, std::optional<std::chrono::seconds> patience) {
  Connection connection(uri, patience);
  const Rows rows = connection.run("SELECT max(version), max(oldest_client) FROM byre.schema_version");
  const auto schema = static_cast<int>(rows.number(0, 0));
  if (rows.number(0, 1) > kRegistrySchema) refuse_newer(connection, schema);
  if (schema < kRegistrySchema) {
    throw InputError(connection.place(),
                     fmt::format("has schema {}, and this byre needs schema {}", schema, kRegistrySchema),
                     "update it with byre registry migrate");
  }
  return connection;
}

}  // namespace byre
