#pragma once

#include "byre/viewer/web/connection_table.h"

namespace byre {

// Entry of a connection in a ConnectionTable, released on destruction.
class ConnectionSlot {
 public:
  // The table outlives this.
  ConnectionSlot(ConnectionTable& table, ConnectionTable::Id id) : table_(table), id_(id) {}
  ~ConnectionSlot() { table_.close(id_); }
  ConnectionSlot(const ConnectionSlot&) = delete;
  ConnectionSlot& operator=(const ConnectionSlot&) = delete;

  bool accept() { return table_.accept(id_); }

 private:
  ConnectionTable& table_;
  ConnectionTable::Id id_;
};

}  // namespace byre
