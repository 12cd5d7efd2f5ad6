// OpenEXR's own pool: what it has no thread for waits there, beside its own work.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_threads.h"

#include <IlmThreadPool.h>

#include <algorithm>
#include <exception>
#include <mutex>

namespace alcove {
namespace {

/// Keeps the first exception of several threads.
class FirstError {
 public:
  void keep(std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(error);
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr error_;
};

class FunctionTask : public IlmThread::Task {
 public:
  FunctionTask(IlmThread::TaskGroup* group, const std::function<void()>& function, FirstError& error)
      : Task(group), function_(function), error_(error) {}
  void execute() override {
    try {
      function_();
    } catch (...) {
      error_.keep(std::current_exception());
    }
  }

 private:
  const std::function<void()>& function_;
  FirstError& error_;
};

}  // namespace

int exr_threads_for(int pieces, int most) {
  const int threads = std::min({pieces, most, IlmThread::ThreadPool::globalThreadPool().numThreads()});
  return threads > 1 ? threads : 0;
}

void on_exr_threads(int threads, const std::function<void()>& function) {
  if (threads == 0) return function();
  FirstError error;
  {
    IlmThread::TaskGroup group;  // whose end waits for its tasks
    for (int i = 0; i < threads; i++) IlmThread::ThreadPool::addGlobalTask(new FunctionTask(&group, function, error));
  }
  error.rethrow();
}

}  // namespace alcove
