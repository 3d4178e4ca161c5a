#pragma once

#include <functional>

namespace byre {

// Calls work for each row, 0 to rows - 1, on several threads (0: one per core). The assignment of rows to threads
// varies: rows must be independent, and work must not throw.
void for_each_row(int rows, int threads, const std::function<void(int row)>& work);

}  // namespace byre
