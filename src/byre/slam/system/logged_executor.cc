#include "byre/slam/system/logged_executor.h"

#include "byre/base/stopwatch.h"

#include <utility>

namespace byre {
namespace {

class LoggedExecutor final : public Executor {
 public:
  LoggedExecutor(std::unique_ptr<Executor> executor, JobLog& log) : executor_(std::move(executor)), log_(log) {}

  void submit(Job job) override {
    const Stopwatch watch;
    executor_->submit(std::move(job));
    log_.submit_seconds += watch.seconds();
  }
  std::optional<FinishedJob> collect() override { return logged(executor_->collect()); }
  std::optional<FinishedJob> collect_early() override { return logged(executor_->collect_early()); }
  std::optional<FinishedJob> finish() override { return logged(executor_->finish()); }
  bool idle() const override { return executor_->idle(); }

 private:
  std::optional<FinishedJob> logged(std::optional<FinishedJob> finished) {
    if (finished) log_.job_seconds.push_back(finished->seconds);
    return finished;
  }

  std::unique_ptr<Executor> executor_;
  JobLog& log_;
};

}  // namespace

std::unique_ptr<Executor> make_logged_executor(std::unique_ptr<Executor> executor, JobLog& log) {
  return std::make_unique<LoggedExecutor>(std::move(executor), log);
}

}  // namespace byre
