// OpenEXR's own pool: what it has no thread for waits there, beside its own work.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_threads.h"

#include <IlmThreadPool.h>

#include <algorithm>
#include <exception>
#include <mutex>

namespace alcove {
namespace {

/// What several threads do together, and the first exception among theirs. All hand over under a mutex of ours, since
/// the thread sanitizer does not see that of the pool.
class Shared {
 public:
  explicit Shared(const std::function<void()>& function) : function_(function) { const std::lock_guard lock(mutex_); }

  void work() {
    { const std::lock_guard lock(mutex_); }
    std::exception_ptr error;
    try {
      function_();
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = error;
  }

  /// Call it once all have worked.
  void end() {
    const std::lock_guard lock(mutex_);
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const std::function<void()>& function_;
  std::mutex mutex_;
  std::exception_ptr error_;
};

class SharedTask : public IlmThread::Task {
 public:
  SharedTask(IlmThread::TaskGroup* group, Shared& shared) : Task(group), shared_(shared) {}
  void execute() override { shared_.work(); }

 private:
  Shared& shared_;
};

}  // namespace

int exr_threads() { return IlmThread::ThreadPool::globalThreadPool().numThreads(); }

int exr_threads_for(int pieces, int most) {
  const int threads = std::min({pieces, most, exr_threads()});
  return threads > 1 ? threads : 0;
}

void on_exr_threads(int threads, const std::function<void()>& function) {
  if (threads == 0) return function();
  Shared shared(function);
  {
    IlmThread::TaskGroup group;  // whose end waits for its tasks
    for (int i = 0; i < threads; i++) IlmThread::ThreadPool::addGlobalTask(new SharedTask(&group, shared));
  }
  shared.end();
}

}  // namespace alcove
