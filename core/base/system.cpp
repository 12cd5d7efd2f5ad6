// POSIX and Linux, behind plain functions.
// SPDX-License-Identifier: BSD-3-Clause
//
// Sources: Linux's Documentation/admin-guide/cgroup-v2.rst ("Memory Interface Files") and cgroup-v1/memory.rst, the
// manual pages cgroups(7) and proc_pid_mountinfo(5), and sbatch(1) for Slurm's variables.
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
#include <charconv>
#include <cinttypes>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/text.h"

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

/// Takes the lock that marks a file as being written. File systems without locks lock nothing; there, only a caller
/// that waits goes on without a lock.
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

/// Whether the error only means that the file system lacks the call.
bool is_unsupported(int error) { return error == EINVAL || error == ENOSYS || error == ENOTSUP || error == EROFS; }

}  // namespace

int process_id() { return int(::getpid()); }

std::string program_folder() {
  // Not /proc/self/exe, which is the loader of the C library if that was told to start the program, as in the archive.
  const auto here = reinterpret_cast<std::uintptr_t>(&program_folder);
  std::string line;
  for (std::ifstream maps("/proc/self/maps"); std::getline(maps, line);) {
    std::uintptr_t begin = 0, end = 0;
    const bool is_range = std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR, &begin, &end) == 2;
    if (is_range && begin <= here && here < end)
      return std::filesystem::path(line.substr(std::min(line.find('/'), line.size()))).parent_path().string();
  }
  return {};
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

void prepare_streams() {}

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

std::string config_home() {
  const char *config = std::getenv("XDG_CONFIG_HOME"), *home = std::getenv("HOME");
  return config && *config ? config : home ? std::string(home) + "/.config" : "";
}

std::string file_id(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return "";
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

std::error_code may_read(const std::string& path) {
  return ::access(path.c_str(), R_OK) == 0 ? std::error_code() : last_error();
}

std::error_code may_make_files_in(const std::string& folder) {
  return ::access(folder.c_str(), W_OK | X_OK) == 0 ? std::error_code() : last_error();
}

std::error_code rename_over(const std::string& from, const std::string& to) {
  return std::rename(from.c_str(), to.c_str()) == 0 ? std::error_code() : last_error();
}

void sync_folder(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
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
  // Only root may give files away; members of a group may hand files over to it.
  const bool has_owner = ::fchown(descriptor_, before.st_uid, before.st_gid) == 0;
  const bool has_group = has_owner || ::fchown(descriptor_, uid_t(-1), before.st_gid) == 0;
  // Without its group, the permissions for the group would let others in.
  const mode_t kept = has_owner ? 07777 : has_group ? 0777 : 0707;
  ::fchmod(descriptor_, before.st_mode & kept);
}

std::error_code LockedFile::sync() {
  // On network file systems, signals can interrupt these calls.
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

namespace {

/// The names of the files of one version of control groups.
struct GroupFiles {
  std::vector<const char*> limits;  // each a number of bytes, or "max"
  const char* usage;
  std::vector<std::string> caches;  // words of memory.stat: cached files, which are dropped if memory is short
};
const GroupFiles kVersion1{
    {"memory.limit_in_bytes"}, "memory.usage_in_bytes", {"total_inactive_file", "total_active_file"}};
// Above memory.high, processes are slowed down to a standstill.
const GroupFiles kVersion2{{"memory.max", "memory.high"}, "memory.current", {"inactive_file", "active_file"}};

std::optional<std::uint64_t> number_in(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

/// The only number in a file; nothing if there is none, as in "max".
std::optional<std::uint64_t> number_of_file(const std::string& path) {
  std::ifstream file(path);
  std::string word;
  return file >> word ? number_in(word) : std::nullopt;
}

/// The sum of the numbers behind the given words at the beginnings of a file's lines; nothing if no line has any.
std::optional<std::uint64_t> sum_of_lines(const std::string& path, const std::vector<std::string>& words) {
  std::ifstream file(path);
  std::optional<std::uint64_t> sum;
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string word, value;
    if (!(fields >> word >> value) || std::ranges::find(words, word) == words.end()) continue;
    if (const auto number = number_in(value)) sum = sum.value_or(0) + *number;
  }
  return sum;
}

/// The bytes left in one group, without regard to the groups above it.
std::uint64_t left_in_group(const std::string& folder, const GroupFiles& files) {
  std::uint64_t limit = kNoMemoryLimit;
  for (const char* name : files.limits)
    limit = std::min(limit, number_of_file(folder + "/" + name).value_or(kNoMemoryLimit));
  if (limit == kNoMemoryLimit) return limit;
  const std::uint64_t usage = number_of_file(folder + "/" + files.usage).value_or(0),
                      caches = sum_of_lines(folder + "/memory.stat", files.caches).value_or(0);
  const std::uint64_t taken = usage - std::min(usage, caches);
  return limit - std::min(limit, taken);
}

/// A mounted hierarchy of control groups: the group that its folder shows.
struct GroupMount {
  std::string group, folder;
  bool is_version_2 = false;
};

/// mountinfo writes spaces, tabs, line ends and backslashes of names as three octal digits.
std::string unescaped(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); i++) {
    unsigned char letter = 0;
    const char* const digits = text.data() + i + 1;
    const bool is_escape =
        text[i] == '\\' && i + 3 < text.size() && std::from_chars(digits, digits + 3, letter, 8).ptr == digits + 3;
    plain += is_escape ? char(letter) : text[i];
    if (is_escape) i += 3;
  }
  return plain;
}

bool is_in_list(const std::string& word, const std::string& list) {
  const auto words = split(list);
  return std::ranges::find(words, word) != words.end();
}

/// The mounts of the hierarchies that limit memory. A line is "ID PARENT MAJOR:MINOR GROUP FOLDER OPTIONS ... - TYPE
/// SOURCE OPTIONS", with any number of optional fields before the dash.
std::vector<GroupMount> group_mounts(const std::string& root) {
  std::ifstream file(root + "/proc/self/mountinfo");
  std::vector<GroupMount> mounts;
  for (std::string line; std::getline(file, line);) {
    const std::size_t dash = line.find(" - ");
    if (dash == line.npos) continue;
    std::istringstream before(line.substr(0, dash)), after(line.substr(dash + 3));
    std::string skipped, group, folder, type, source, options;
    before >> skipped >> skipped >> skipped >> group >> folder;
    after >> type >> source >> options;
    const bool limits_memory = type == "cgroup2" || (type == "cgroup" && is_in_list("memory", options));
    if (limits_memory && !folder.empty()) mounts.push_back({unescaped(group), unescaped(folder), type == "cgroup2"});
  }
  return mounts;
}

/// The least bytes left in a group and in all visible groups above it.
std::uint64_t left_upwards(const std::string& root, const GroupMount& mount, const std::string& group) {
  // A container may see its own group as the top of the hierarchy, or by a path that leads outside of its view.
  const std::string top = mount.group == "/" ? "" : mount.group;
  std::string below = (group + "/").starts_with(top + "/") ? group.substr(top.size()) : "";
  if (below.find("/..") != below.npos) below.clear();
  while (below.ends_with('/')) below.pop_back();

  const GroupFiles& files = mount.is_version_2 ? kVersion2 : kVersion1;
  std::uint64_t least = kNoMemoryLimit;
  while (true) {
    least = std::min(least, left_in_group(root + mount.folder + below, files));
    if (below.empty()) return least;
    below.resize(below.rfind('/') == below.npos ? 0 : below.rfind('/'));
  }
}

/// The number in an environment variable; nothing if it holds none, or one too large for any machine.
std::optional<std::uint64_t> number_of_variable(const char* name) {
  constexpr std::uint64_t kMost = 1ull << 28;  // MiB: 256 TiB
  const char* text = std::getenv(name);
  const auto number = text ? number_in(text) : std::nullopt;
  return number && *number <= kMost ? number : std::nullopt;
}

}  // namespace

std::uint64_t memory_left_in_groups(const std::string& root) {
  const std::vector<GroupMount> mounts = group_mounts(root);
  std::ifstream file(root + "/proc/self/cgroup");
  std::uint64_t least = kNoMemoryLimit;
  // A line is "ID:CONTROLLERS:GROUP"; version 2 names no controllers.
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string id, controllers, group;
    std::getline(std::getline(fields, id, ':'), controllers, ':');
    if (!std::getline(fields, group)) continue;
    if (!controllers.empty() && !is_in_list("memory", controllers)) continue;
    for (const auto& mount : mounts)
      if (mount.is_version_2 == controllers.empty()) least = std::min(least, left_upwards(root, mount, group));
  }
  return least;
}

std::uint64_t memory_left_on_machine(const std::string& root) {
  constexpr std::uint64_t kUnit = 1024;  // bytes: the file counts in kB, by which it means KiB
  const auto available = sum_of_lines(root + "/proc/meminfo", {"MemAvailable:"});
  return available ? *available * kUnit : kNoMemoryLimit;
}

std::uint64_t memory_of_slurm_job() {
  constexpr std::uint64_t kUnit = 1 << 20;  // bytes: Slurm counts in MB, by which it means MiB
  // 0 asks for all memory of the node.
  if (const auto of_node = number_of_variable("SLURM_MEM_PER_NODE"); of_node && *of_node > 0) return *of_node * kUnit;
  const auto of_core = number_of_variable("SLURM_MEM_PER_CPU"), cores = number_of_variable("SLURM_CPUS_ON_NODE");
  constexpr std::uint64_t kMostCores = 1 << 15;
  if (of_core && cores && *of_core > 0 && *cores > 0) return *of_core * std::min(*cores, kMostCores) * kUnit;
  return kNoMemoryLimit;
}

std::uint64_t free_memory() {
  return std::min({memory_left_in_groups(), memory_left_on_machine(), memory_of_slurm_job()});
}

}  // namespace alcove
