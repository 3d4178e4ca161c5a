#pragma once

#include "byre/io/bag/bag.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace byre {

// A database of rosbag2. Reads only its tables topics and messages.
class SqliteBag final : public Bag {
 public:
  // Throws InputError if it cannot be opened or lacks these tables. place: name of the file in errors.
  SqliteBag(const std::filesystem::path& path, std::string place, const TypeFilter& wanted);
  ~SqliteBag() override;

  std::vector<std::byte> read(const BagMessage& message) override;

 private:
  using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;
  struct Database {
    sqlite3* handle = nullptr;
    ~Database();
  };

  [[noreturn]] void fail() const;
  Statement prepare(const char* text) const;
  void read_topics(const TypeFilter& wanted);
  void read_messages();

  std::string place_;  // constant after construction
  Database database_;
  Statement message_;                    // selects the bytes of a row
  std::vector<std::int64_t> topic_ids_;  // ids in the database, by topic
  std::vector<bool> is_wanted_;          // indexed by topic
};

}  // namespace byre
