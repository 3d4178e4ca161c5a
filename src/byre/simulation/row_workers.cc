#include "byre/simulation/row_workers.h"

#include "byre/base/task_threads.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace byre {

void for_each_row(int rows, int threads, const std::function<void(int row)>& work) {
  const int others = std::min(threads > 0 ? threads : processor_count(), rows) - 1;
  std::atomic<int> next = 0;
  const auto work_on = [&] {
    for (int row = next++; row < rows; row = next++) work(row);
  };
  std::vector<std::jthread> workers;
  for (int i = 0; i < others; ++i) workers.emplace_back(work_on);
  work_on();
}

}  // namespace byre
