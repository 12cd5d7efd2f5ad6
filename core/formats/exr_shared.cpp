// Work that the sources of EXR files share: names and types of OpenEXR, and its pool of threads.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_shared.h"

#include <IlmThreadPool.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <set>

#include "core/formats/sample_loops.h"

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
  static const std::set<std::string> kNames = {"channels",
                                               "compression",
                                               "dataWindow",
                                               "displayWindow",
                                               "pixelAspectRatio",
                                               "lineOrder",
                                               "tiles",
                                               "chunkCount",
                                               "type",
                                               "version",
                                               "name",
                                               "preview",
                                               "dwaCompressionLevel",
                                               "zipCompressionLevel",
                                               "multiView",
                                               "deepImageState",
                                               "maxSamplesPerPixel",
                                               "idManifest",
                                               "BlenderMultiChannel"};
  return kNames.contains(name) || name.rfind("cryptomatte/", 0) == 0;
}

bool is_own_attribute(std::string_view name) { return name.starts_with("alcove/"); }

Imf::Compression compression_of(const std::string& name) {
  if (name == "none") return Imf::NO_COMPRESSION;
  if (name == "rle") return Imf::RLE_COMPRESSION;
  if (name == "zips") return Imf::ZIPS_COMPRESSION;
  if (name == "piz") return Imf::PIZ_COMPRESSION;
  if (name == "dwaa") return Imf::DWAA_COMPRESSION;
  if (name == "dwab") return Imf::DWAB_COMPRESSION;
  return Imf::ZIP_COMPRESSION;
}

Imf::PixelType pixel_type_of(SampleType type) { return type == SampleType::half_float ? Imf::HALF : Imf::FLOAT; }

Imf::Slice slice_of(const Window& rows, SampleType type, std::span<const float> pixels,
                    std::deque<std::vector<std::uint16_t>>& halves) {
  const bool is_half = type == SampleType::half_float;
  const std::size_t bytes = is_half ? sizeof(std::uint16_t) : sizeof(float);
  if (is_half) narrow(pixels.data(), pixels.size(), halves.emplace_back(pixels.size()).data());
  const void* values = is_half ? static_cast<const void*>(halves.back().data()) : pixels.data();
  return Imf::Slice::Make(pixel_type_of(type), values, box_of(rows), bytes, bytes * std::size_t(rows.width));
}

}  // namespace alcove
