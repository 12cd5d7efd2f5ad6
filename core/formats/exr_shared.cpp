// Work that the sources of EXR files share: names and types of OpenEXR, and its pool of threads.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_shared.h"

#include <IlmThreadPool.h>

#include <algorithm>
#include <exception>
#include <mutex>

#include "core/base/text.h"

namespace alcove {

namespace {

/// Pieces of work that several threads share. They hand over under a mutex of this class, since the thread sanitizer
/// does not see that of the pool.
class Shared {
 public:
  Shared(std::size_t pieces, const std::function<void(std::size_t, std::size_t)>& work) : pieces_(pieces), work_(work) {
    const std::lock_guard lock(mutex_);
  }

  void help() {
    std::unique_lock lock(mutex_);
    const std::size_t worker = workers_++;
    while (next_ < pieces_) {
      const std::size_t piece = next_++;
      lock.unlock();
      std::exception_ptr failure;
      try {
        work_(piece, worker);
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
      if (!failure) continue;
      next_ = pieces_;
      if (!failure_ || piece < failed_) failure_ = failure, failed_ = piece;
    }
  }

  /// Throws the failure, if any. Call it after all threads have helped.
  void end() {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  const std::size_t pieces_;
  const std::function<void(std::size_t, std::size_t)>& work_;
  std::mutex mutex_;
  std::size_t workers_ = 0, next_ = 0, failed_ = 0;
  std::exception_ptr failure_;
};

class SharedTask : public IlmThread::Task {
 public:
  SharedTask(IlmThread::TaskGroup* group, Shared& shared) : Task(group), shared_(shared) {}
  void execute() override { shared_.help(); }

 private:
  Shared& shared_;
};

}  // namespace

std::size_t exr_workers(std::size_t pieces, std::size_t most) {
  const int threads = IlmThread::ThreadPool::globalThreadPool().numThreads();
  return std::max<std::size_t>(1, std::min({pieces, most, std::size_t(std::max(0, threads))}));
}

void on_exr_threads(std::size_t pieces, std::size_t workers,
                    const std::function<void(std::size_t, std::size_t)>& work) {
  Shared shared(pieces, work);
  if (workers <= 1) {
    shared.help();
  } else {
    IlmThread::TaskGroup group;  // whose end waits for its tasks
    for (std::size_t i = 0; i < workers; i++) IlmThread::ThreadPool::addGlobalTask(new SharedTask(&group, shared));
  }
  shared.end();
}

std::string one_line(const std::exception& error) {
  std::string text = error.what();
  std::ranges::replace(text, '\n', ' ');
  return text;
}

bool describes_storage(const std::string& name) {
  static const std::vector<std::string> kNames = split(
      "channels, compression, dataWindow, displayWindow, pixelAspectRatio, lineOrder, tiles, chunkCount, type, "
      "version, name, preview, dwaCompressionLevel, zipCompressionLevel, multiView, deepImageState, "
      "maxSamplesPerPixel, idManifest, BlenderMultiChannel");
  return std::ranges::find(kNames, name) != kNames.end() || name.starts_with("cryptomatte/");
}

}  // namespace alcove
