#include "byre/io/bag/sqlite_bag.h"

#include "byre/base/regular_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <span>
#include <system_error>

#include <sqlite3.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Opened as immutable unless a recorder left a journal, so that SQLite creates no files in its folder.
std::string address_of(const fs::path& path) {
  std::error_code error;
  fs::path journal = path;
  journal += "-wal";
  const bool has_journal = fs::exists(journal, error) && fs::file_size(journal, error) > 0;
  std::string address = "file:";
  for (const char letter : fs::absolute(path).string()) {
    if (letter == '?' || letter == '#' || letter == '%') {
      constexpr const char* kDigits = "0123456789ABCDEF";
      address.append({'%', kDigits[letter >> 4], kDigits[letter & 15]});
    } else {
      address += letter;
    }
  }
  return address + (has_journal ? "?mode=ro" : "?mode=ro&immutable=1");
}

std::string text_at(sqlite3_stmt* row, int column) {
  const unsigned char* const text = sqlite3_column_text(row, column);
  return text == nullptr ? std::string() : reinterpret_cast<const char*>(text);
}

std::span<const std::byte> bytes_at(sqlite3_stmt* row, int column) {
  const void* const bytes = sqlite3_column_blob(row, column);
  const int size = sqlite3_column_bytes(row, column);
  return {static_cast<const std::byte*>(bytes), bytes == nullptr ? 0 : static_cast<std::size_t>(size)};
}

}  // namespace

SqliteBag::Database::~Database() {
  sqlite3_close_v2(handle);
}

SqliteBag::~SqliteBag() = default;

SqliteBag::SqliteBag(const fs::path& path, std::string place, const TypeFilter& wanted)
    : place_(std::move(place)), message_(nullptr, sqlite3_finalize) {
  refuse_pipe(path);
  const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
  if (sqlite3_open_v2(address_of(path).c_str(), &database_.handle, flags, nullptr) != SQLITE_OK) fail();
  // Restricts a malicious file: only two tables are read.
  sqlite3_db_config(database_.handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(database_.handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database_.handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(database_.handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  content_.storage = "sqlite3";
  content_.bytes = fs::file_size(path);
  read_topics(wanted);
  read_messages();
  message_ = prepare("SELECT data FROM messages WHERE id = ?");
}

void SqliteBag::fail() const {
  const std::string why = database_.handle == nullptr ? "out of memory" : sqlite3_errmsg(database_.handle);
  throw InputError(place_, "cannot be read as a rosbag2 database: " + why,
                   "use a copy, or recover data with \"sqlite3 FILE .recover\"");
}

SqliteBag::Statement SqliteBag::prepare(const char* text) const {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.handle, text, -1, &statement, nullptr) != SQLITE_OK) fail();
  return {statement, sqlite3_finalize};
}

void SqliteBag::read_topics(const TypeFilter& wanted) {
  // The first versions of rosbag2 have no column of formats, and write CDR.
  const Statement formats = prepare("SELECT 1 FROM pragma_table_info('topics') WHERE name = 'serialization_format'");
  const bool has_formats = sqlite3_step(formats.get()) == SQLITE_ROW;
  const Statement topics = prepare(has_formats ? "SELECT id, name, type, serialization_format FROM topics ORDER BY id"
                                               : "SELECT id, name, type, 'cdr' FROM topics ORDER BY id");
  int result = SQLITE_OK;
  while ((result = sqlite3_step(topics.get())) == SQLITE_ROW) {
    topic_ids_.push_back(sqlite3_column_int64(topics.get(), 0));
    content_.topics.push_back({text_at(topics.get(), 1), text_at(topics.get(), 2), text_at(topics.get(), 3)});
    is_wanted_.push_back(wanted(content_.topics.back().type));
  }
  if (result != SQLITE_DONE) fail();
}

// Reads in the order of rows, which is that of the file; avoids reading the bytes of large messages.
void SqliteBag::read_messages() {
  const Statement messages = prepare("SELECT id, topic_id, timestamp, substr(data, 1, 16) FROM messages");
  int result = SQLITE_OK;
  std::uint64_t unknown = 0;
  while ((result = sqlite3_step(messages.get())) == SQLITE_ROW) {
    const auto topic = std::ranges::find(topic_ids_, sqlite3_column_int64(messages.get(), 1));
    if (topic == topic_ids_.end()) {
      ++unknown;
      continue;
    }
    const auto number = static_cast<std::size_t>(topic - topic_ids_.begin());
    const Timestamp log_time(sqlite3_column_int64(messages.get(), 2));
    ++content_.message_count;
    ++content_.topics[number].messages;
    content_.first = std::min(content_.first.value_or(log_time), log_time);
    content_.last = std::max(content_.last.value_or(log_time), log_time);
    if (!is_wanted_[number]) continue;
    BagMessage message{number, log_time};
    message.place.begin = static_cast<std::uint64_t>(sqlite3_column_int64(messages.get(), 0));
    const std::span<const std::byte> head = bytes_at(messages.get(), 3);
    std::ranges::copy(head.first(std::min(head.size(), message.head.size())), message.head.begin());
    content_.messages.push_back(message);
  }
  if (result != SQLITE_DONE) {
    content_.damage.push_back(
        place_ + ": is damaged; only the part before the damage was read: " + sqlite3_errmsg(database_.handle));
  }
  if (unknown > 0) {
    content_.damage.push_back(place_ + ": " + std::to_string(unknown) + " messages belong to undeclared topics");
  }
  std::ranges::stable_sort(content_.messages, {}, &BagMessage::log_time);
}

std::vector<std::byte> SqliteBag::read(const BagMessage& message) {
  sqlite3_reset(message_.get());
  sqlite3_bind_int64(message_.get(), 1, static_cast<sqlite3_int64>(message.place.begin));
  if (sqlite3_step(message_.get()) != SQLITE_ROW) fail();
  const std::span<const std::byte> bytes = bytes_at(message_.get(), 0);
  std::vector<std::byte> copy(bytes.begin(), bytes.end());
  sqlite3_reset(message_.get());
  return copy;
}

}  // namespace byre
