// Bytes that end where nobody may read or write: whoever takes one more than there are ends the test, without a
// sanitizer too.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <span>

namespace alcove::test {

class GuardedBytes {
 public:
  explicit GuardedBytes(std::size_t size) : size_(size) {
    const auto page = std::size_t(sysconf(_SC_PAGESIZE));
    const std::size_t usable = (size + page - 1) / page * page;
    mapped_ = usable + page;
    void* const at = mmap(nullptr, mapped_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
    start_ = static_cast<std::uint8_t*>(at);
    begin_ = start_ + (usable - size);
    if (mprotect(start_ + usable, page, PROT_NONE) != 0) throw std::bad_alloc();
  }
  explicit GuardedBytes(std::span<const std::uint8_t> bytes) : GuardedBytes(bytes.size()) {
    std::ranges::copy(bytes, begin_);
  }
  ~GuardedBytes() { munmap(start_, mapped_); }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;

  std::span<std::uint8_t> bytes() const { return {begin_, size_}; }

 private:
  std::size_t size_, mapped_ = 0;
  std::uint8_t *start_ = nullptr, *begin_ = nullptr;
};

}  // namespace alcove::test
