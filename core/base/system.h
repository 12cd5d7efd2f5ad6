// Everything that Alcove asks of the operating system. Only system.cpp and, for Windows, system_windows.cpp include its
// headers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <system_error>
#include <utility>

namespace alcove {

// The process and its machine.

/// The number of this process.
int process_id();

/// The folder of the running program, or of the library that this is part of; empty if the system does not tell it.
std::string program_folder();

/// The system and its kernel, such as "Debian GNU/Linux 12 (bookworm), Linux 6.1.0 x86_64".
std::string system_name();

/// The number of cores that the process may use, at least 1.
int core_count();

/// The largest memory of the process so far, in bytes.
std::uint64_t peak_memory_bytes();

/// The present memory of the process, in bytes.
std::uint64_t resident_memory_bytes();

/// Makes the process return memory: freed blocks that are not small go to the system at once, and threads share arenas.
void keep_no_spare_memory();

/// The computing time of all threads so far, in seconds.
double cpu_seconds();

/// Sets a variable of the environment for this process and for the libraries that it loads.
void set_environment(const std::string& name, const std::string& value);

/// The standard output of a shell command; empty if it cannot be started.
std::string output_of_command(const std::string& command);

/// Makes the standard streams of a program carry bytes as they are, which terminals take for UTF-8. Windows needs it.
void prepare_streams();

/// Whether the standard error is a terminal, not a file or pipe.
bool errors_go_to_terminal();

/// Catches the signals that ask a program to end (SIGHUP, SIGINT and SIGTERM): caught_signal() tells the first, and a
/// second one of its kind ends the process. SIGHUP stays ignored if the process was started so, as `nohup` does.
void catch_ending_signals();
/// The number of the caught signal; 0 for none. Every thread may ask.
int caught_signal();

/// The address of a symbol in a library, which is loaded if need be. If it fails, it gives null, with the reason in
/// `why`.
void* symbol_of(const char* library, const char* symbol, std::string& why);

// The memory that the process may still take, after the limits of containers, systemd and batch systems.

constexpr std::uint64_t kMebibyte = 1 << 20;  // bytes
constexpr std::uint64_t kNoMemoryLimit = std::numeric_limits<std::uint64_t>::max();

/// The bytes that the control groups of this process leave it: the least of its own group and of all groups above it.
/// kNoMemoryLimit without a readable limit. Both versions of control groups are read. `root` is a folder that stands
/// for the whole file system.
std::uint64_t memory_left_in_groups(const std::string& root = "/");

/// The bytes that the machine can still give away, by Linux's own estimate (MemAvailable of /proc/meminfo).
std::uint64_t memory_left_on_machine(const std::string& root = "/");

/// The bytes of memory on this node that a Slurm job has asked for, by its environment variables. Slurm need not
/// enforce them by control groups, but ends jobs that take more.
std::uint64_t memory_of_slurm_job();

/// The free memory in bytes: the least of the three functions above.
std::uint64_t free_memory();

// Files and folders.

/// The folder of a user's settings: that of the XDG base directory specification, on Windows %APPDATA%; empty if the
/// environment names none.
std::string config_home();

/// The file that a path leads to, as a text that every name of it gives and no other file has, through links of both
/// kinds; "" if there is none.
std::string file_id(const std::string& path);
/// Empty if the process may read the file, else the reason why not.
std::error_code may_read(const std::string& path);
/// Empty if the process may make files in the folder, else the reason why not.
std::error_code may_make_files_in(const std::string& folder);

/// Gives a file a name beside its own in one step, so that the file that had it stays until then. On Windows it waits
/// up to a second for other programs that have the file open.
std::error_code rename_over(const std::string& from, const std::string& to);

/// Puts a folder's names on the disk, so that they outlive a loss of power. It does nothing on file systems that cannot
/// do it.
void sync_folder(const std::string& folder);

/// A file that only this process writes: it is locked while it is open. On file systems without locks it is only open.
/// Moves, never copies.
class LockedFile {
 public:
  LockedFile() = default;
  LockedFile(LockedFile&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), is_locked_(other.is_locked_) {}
  LockedFile& operator=(LockedFile&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(is_locked_, other.is_locked_);
    return *this;
  }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;
  ~LockedFile() { close(); }

  /// Makes a new file; fails if the name is taken.
  std::error_code make(const std::string& path);
  /// Opens a file that no living process has locked. It follows no link, and waits for no pipe.
  std::error_code open_abandoned(const std::string& path);

  bool is_open() const { return descriptor_ >= 0; }
  /// Whether somebody removed the file's name before it was locked.
  bool is_removed() const;

  std::error_code write_at(std::uint64_t offset, std::span<const char> bytes);
  /// Takes over the permissions of the regular file at `path`, and its owner and group as far as this process may give
  /// files away. Does nothing if there is none.
  void take_after(const std::string& path);
  /// Puts the bytes on the disk, and asks for errors that a file system reports only when a file is closed. The file
  /// stays open and locked.
  std::error_code sync();
  void close();

 private:
  int descriptor_ = -1;
  bool is_locked_ = false;
};

/// A stopwatch for wall time, which runs from its construction on.
class Stopwatch {
 public:
  /// The milliseconds since the construction.
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace alcove
