// POSIX and Linux, behind plain functions.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/system.h"

#include <dlfcn.h>
#include <fcntl.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>

namespace alcove {
namespace {

std::error_code last_error() { return {errno, std::generic_category()}; }

rusage usage_of_process() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage;
}

std::atomic<int> signal_number = 0;
static_assert(std::atomic<int>::is_always_lock_free, "or else no signal handler may touch it");

/// Remembers the first signal.
void remember_signal(int number) {
  int none = 0;
  signal_number.compare_exchange_strong(none, number);
}

/// Takes the lock that says "somebody is writing this". On file systems without locks nothing is locked: then only
/// who waits for the lock goes on without it.
bool lock(int descriptor, bool waits) {
  while (::flock(descriptor, LOCK_EX | (waits ? 0 : LOCK_NB)) != 0)
    if (errno != EINTR) return waits && errno != EWOULDBLOCK;
  return true;
}

std::error_code write_bytes_at(int descriptor, std::uint64_t offset, std::span<const char> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), off_t(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return last_error();
    if (written == 0) return std::make_error_code(std::errc::no_space_on_device);
    bytes = bytes.subspan(std::size_t(written));
    offset += std::uint64_t(written);
  }
  return {};
}

/// Whether a file system merely does not know the call.
bool is_unsupported(int error) { return error == EINVAL || error == ENOSYS || error == ENOTSUP || error == EROFS; }

}  // namespace

int process_id() { return int(::getpid()); }

std::string program_folder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path().string();
}

std::string system_name() {
  std::string name, line;
  constexpr std::string_view kKey = "PRETTY_NAME=\"";
  for (std::ifstream file("/etc/os-release"); std::getline(file, line);)
    if (line.starts_with(kKey)) name = line.substr(kKey.size(), line.find('"', kKey.size()) - kKey.size()) + ", ";
  utsname kernel{};
  ::uname(&kernel);
  return name + kernel.sysname + " " + kernel.release + " " + kernel.machine;
}

int core_count() { return int(std::max(1u, std::thread::hardware_concurrency())); }

std::uint64_t peak_memory_bytes() { return std::uint64_t(usage_of_process().ru_maxrss) << 10; }

std::uint64_t resident_memory_bytes() {
  std::uint64_t whole = 0, resident = 0;  // pages
  std::ifstream("/proc/self/statm") >> whole >> resident;
  return resident * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

void keep_no_spare_memory() {
#ifdef __GLIBC__
  constexpr int kLarge = 1 << 20;  // bytes
  ::mallopt(M_MMAP_THRESHOLD, kLarge);
  ::mallopt(M_TRIM_THRESHOLD, kLarge);
  ::mallopt(M_ARENA_MAX, 2);
#endif
}

double cpu_seconds() {
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  const rusage usage = usage_of_process();
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void set_environment(const std::string& name, const std::string& value) { ::setenv(name.c_str(), value.c_str(), 1); }

std::string output_of_command(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  std::string text;
  std::array<char, 256> line;
  while (pipe && std::fgets(line.data(), int(line.size()), pipe.get())) text += line.data();
  return text;
}

bool errors_go_to_terminal() { return ::isatty(STDERR_FILENO) != 0; }

void catch_ending_signals() {
  struct sigaction action {};
  action.sa_handler = remember_signal;
  action.sa_flags = int(SA_RESETHAND);
  for (const int number : {SIGINT, SIGTERM}) ::sigaction(number, &action, nullptr);

  struct sigaction before {};
  ::sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) ::sigaction(SIGHUP, &action, nullptr);
}

int caught_signal() { return signal_number; }

void* symbol_of(const char* library, const char* symbol, std::string& why) {
  void* loaded = ::dlopen(library, RTLD_NOW | RTLD_LOCAL);
  void* address = loaded ? ::dlsym(loaded, symbol) : nullptr;
  if (!address) why = ::dlerror();
  return address;
}

std::error_code may_read(const std::string& path) {
  return ::access(path.c_str(), R_OK) == 0 ? std::error_code() : last_error();
}

std::error_code may_make_files_in(const std::string& folder) {
  return ::access(folder.c_str(), W_OK | X_OK) == 0 ? std::error_code() : last_error();
}

void sync_folder(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

LockedFile::LockedFile(LockedFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), is_locked_(other.is_locked_) {}

LockedFile& LockedFile::operator=(LockedFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(is_locked_, other.is_locked_);
  return *this;
}

std::error_code LockedFile::make(const std::string& path) {
  close();
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return last_error();
  is_locked_ = lock(descriptor_, true);
  return {};
}

std::error_code LockedFile::open_abandoned(const std::string& path) {
  close();
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor_ < 0) return last_error();
  is_locked_ = lock(descriptor_, false);
  if (is_locked_) return {};
  close();
  return std::make_error_code(std::errc::device_or_resource_busy);
}

bool LockedFile::is_removed() const {
  struct stat status {};
  return is_locked_ && ::fstat(descriptor_, &status) == 0 && status.st_nlink == 0;
}

std::error_code LockedFile::write_at(std::uint64_t offset, std::span<const char> bytes) {
  return write_bytes_at(descriptor_, offset, bytes);
}

void LockedFile::take_after(const std::string& path) {
  struct stat before {};
  if (::lstat(path.c_str(), &before) != 0 || !S_ISREG(before.st_mode)) return;
  // Only root gives files away; whoever is a member of the group may hand over to it.
  const bool has_owner = ::fchown(descriptor_, before.st_uid, before.st_gid) == 0;
  const bool has_group = has_owner || ::fchown(descriptor_, uid_t(-1), before.st_gid) == 0;
  // Without the group that they were meant for, the group's permissions would let others in.
  const mode_t kept = has_owner ? 07777 : has_group ? 0777 : 0707;
  ::fchmod(descriptor_, before.st_mode & kept);
}

std::error_code LockedFile::sync() {
  // File systems of networks let a signal interrupt these calls.
  int failed = 0;
  do {
    failed = ::fsync(descriptor_);
  } while (failed != 0 && errno == EINTR);
  if (failed != 0 && !is_unsupported(errno)) return last_error();
  // The lock stays with the second descriptor.
  const int second = ::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);
  if (second < 0) return last_error();
  // An interrupted close() has closed the descriptor, and the bytes are on the disk.
  if (::close(std::exchange(descriptor_, second)) != 0 && errno != EINTR) return last_error();
  return {};
}

void LockedFile::close() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

}  // namespace alcove
