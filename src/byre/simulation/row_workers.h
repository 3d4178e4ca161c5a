#pragma once

#include <functional>

namespace byre {

// Calls work once for each row, 0 to rows - 1, in so many threads; 0 stands for as many as the machine has. Which
// thread does which row is not fixed: rows must not depend on one another, and work must not throw.
void for_each_row(int rows, int threads, const std::function<void(int row)>& work);

}  // namespace byre
