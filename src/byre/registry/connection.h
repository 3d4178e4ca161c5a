#pragma once

#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

struct pg_conn;
struct pg_result;

namespace byre {

// The server cannot be reached or lacks resources, or the connection broke. The last statement may or may not have been
// executed; another attempt may succeed.
class ConnectionLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Parameter of a statement: text, number, list of texts, bytes or null. Statements are constants; all else is a
// parameter.
class Parameter {
 public:
  Parameter(std::string text) : value_(std::move(text)) {}
  Parameter(const char* text) : value_(text) {}
  Parameter(std::integral auto number) : value_(std::to_string(number)) {}
  Parameter(const std::vector<std::string>& list);
  Parameter(std::span<const std::byte> bytes)
      : value_(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())), is_binary_(true) {}
  Parameter(const std::vector<std::byte>& bytes) : Parameter(std::span(bytes)) {}
  Parameter(const std::optional<std::string>& text) : value_(text) {}

  const char* data() const { return value_ ? value_->c_str() : nullptr; }
  int size() const { return value_ ? static_cast<int>(value_->size()) : 0; }
  bool is_binary() const { return is_binary_; }

 private:
  std::optional<std::string> value_;
  bool is_binary_ = false;
};

// Result of a statement, as text. Rows and columns are counted from 0.
class Rows {
 public:
  explicit Rows(pg_result* result) : result_(result) {}

  const pg_result* get() const { return result_.get(); }
  int size() const;
  int columns() const;
  int changed() const;  // number of rows that the statement inserted or changed
  bool is_null(int row, int column) const;
  std::string text(int row, int column) const;  // empty if null
  std::int64_t number(int row, int column) const;

 private:
  struct Clear {
    void operator()(pg_result* result) const;
  };
  std::unique_ptr<pg_result, Clear> result_;
};

// Connection to a PostgreSQL server. All functions throw ConnectionLost, and InputError for what the server refuses.
class Connection {
 public:
  // uri: as of libpq, "postgresql://..." or "host=... dbname=..."; what it leaves out is in the environment (PGHOST,
  // PGSERVICE, ...). patience: longest wait for the server, to connect and for each answer, after which the connection
  // counts as broken. Empty: 10 s to connect; an answer may take any time unless the network is cut, for 30 s.
  explicit Connection(const std::string& uri, std::optional<std::chrono::seconds> patience = {});

  Rows run(const char* statement, const std::vector<Parameter>& parameters = {});
  // Value of a bytea, the only one of its result. Empty without a row, or if null.
  std::optional<std::vector<std::byte>> bytes(const char* statement, const std::vector<Parameter>& parameters);
  // Several statements without parameters, such as a migration.
  void run_script(const std::string& statements);

  // Waits for a notification of a channel that was listened to. False after the time.
  bool wait_for_notification(std::chrono::milliseconds most);

  void reconnect();  // forgets channels and transactions
  // A token whose stop ends the attempts of persist().
  void stop_by(std::stop_token stop) { stop_ = std::move(stop); }
  bool is_stopped() const { return stop_.stop_requested(); }
  void interrupt() const;  // breaks the connection, for another thread that waits for the server
  const std::string& place() const { return place_; }  // "registry HOST/DATABASE", for messages

 private:
  struct Close {
    void operator()(pg_conn* connection) const;
  };

  void require_connected() const;
  Rows execute(const char* statement, const std::vector<Parameter>& parameters, bool is_binary);
  void await_answer() const;
  void require_success(const Rows& answer) const;

  std::optional<std::chrono::seconds> patience_;  // constant after construction
  std::unique_ptr<pg_conn, Close> connection_;
  std::string place_;
  std::stop_token stop_;
};

// Transaction that is rolled back unless committed.
class Transaction {
 public:
  explicit Transaction(Connection& connection);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit();

 private:
  Connection& connection_;
  bool is_open_ = true;
};

// Runs a function that may be repeated. If the connection breaks, connects again and repeats it, for half a minute or
// until it is stopped.
void persist(Connection& connection, const std::function<void()>& action);

// Schema that this client is made for: the newest file of share/byre/registry.
inline constexpr int kRegistrySchema = 5;

// Schema of a database; 0: it is no registry.
int registry_schema(Connection& connection);

// Applies the files of later schemas, each in a transaction. Returns the schema before. Throws InputError for a
// database that a newer client made.
int migrate_registry(Connection& connection);

// Connects to a registry, see Connection. Throws InputError if its schema is older than kRegistrySchema, or does not
// admit clients made for kRegistrySchema.
Connection open_registry(const std::string& uri, std::optional<std::chrono::seconds> patience = {});

}  // namespace byre
