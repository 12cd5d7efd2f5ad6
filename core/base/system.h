// What Alcove asks of the operating system: the only file that includes its headers, and so the one to port.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <system_error>

namespace alcove {

// The process and its machine.

/// The number of this process.
int process_id();

/// The folder that the running program lies in; empty where the system does not say.
std::string program_folder();

/// The system and its kernel, such as "Debian GNU/Linux 12 (bookworm), Linux 6.1.0 x86_64".
std::string system_name();

/// The number of cores that the process may use, at least 1.
int core_count();

/// The most memory that the process has had so far, in bytes.
std::uint64_t peak_memory_bytes();

/// The memory that the process has now, in bytes.
std::uint64_t resident_memory_bytes();

/// From now on memory that is given back goes to the system at once where it is more than a little, and threads share
/// it, so that the process does not keep what it no longer uses.
void keep_no_spare_memory();

/// The time that all threads of the process have computed so far, in seconds.
double cpu_seconds();

/// Sets a variable of the environment for this process and for the libraries that it loads.
void set_environment(const std::string& name, const std::string& value);

/// What a command of the shell prints to its standard output; empty where it cannot be started.
std::string output_of_command(const std::string& command);

/// Whether the standard error is a terminal, and nobody's file or pipe.
bool errors_go_to_terminal();

/// From now on the signals that ask a program to end (SIGHUP, SIGINT and SIGTERM) do not end the process at once:
/// caught_signal() tells of the first. A second one of its kind ends the process. SIGHUP stays ignored where the
/// process was started so, as `nohup` does.
void catch_ending_signals();
/// The number of the signal that was caught; 0 for none. Every thread may ask.
int caught_signal();

/// The address of a symbol in a library, which is loaded if it is not yet; null where there is none, and why in `why`.
void* symbol_of(const char* library, const char* symbol, std::string& why);

// How much memory the process may still take, after the limits of containers, systemd and batch systems.

constexpr std::uint64_t kMebibyte = 1 << 20;  // bytes
constexpr std::uint64_t kNoMemoryLimit = std::numeric_limits<std::uint64_t>::max();

/// The bytes that the control groups of this process leave it: the least that is left in its own group or in any group
/// above it. kNoMemoryLimit where there is no limit, or none that can be read. Both versions of control groups are
/// read. `root` is a folder that stands for the whole file system.
std::uint64_t memory_left_in_groups(const std::string& root = "/");

/// The bytes that the machine can still give away, after Linux's own estimate (MemAvailable of /proc/meminfo).
std::uint64_t memory_left_on_machine(const std::string& root = "/");

/// The bytes of memory on this node that a Slurm job has asked for, by the variables of its environment. Slurm need not
/// enforce them by control groups, and ends jobs that take more all the same.
std::uint64_t memory_of_slurm_job();

/// The least of the three.
std::uint64_t free_memory();

// Files and folders.

/// Empty where the process may read the file, else why it may not.
std::error_code may_read(const std::string& path);
/// Empty where the process may make files in the folder, else why it may not.
std::error_code may_make_files_in(const std::string& folder);

/// Puts a folder's names on the disk, so that they outlive a loss of power. File systems that cannot do it pass it by.
void sync_folder(const std::string& folder);

/// A file that this process alone writes: it is locked as long as it is open. On file systems without locks it is only
/// open. Moves, never copies.
class LockedFile {
 public:
  LockedFile() = default;
  LockedFile(LockedFile&& other) noexcept;
  LockedFile& operator=(LockedFile&& other) noexcept;
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;
  ~LockedFile() { close(); }

  /// Makes a new file; fails where something of its name is there.
  std::error_code make(const std::string& path);
  /// Opens a file that no living process has locked. A link is not followed, and no pipe is waited for.
  std::error_code open_abandoned(const std::string& path);

  bool is_open() const { return descriptor_ >= 0; }
  /// Whether somebody has removed the file's name before it was locked.
  bool is_removed() const;

  std::error_code write_at(std::uint64_t offset, std::span<const char> bytes);
  /// Takes on the permissions and, as far as this process may give files away, the owner and the group of the regular
  /// file at `path`. Changes nothing where there is none.
  void take_after(const std::string& path);
  /// Puts the bytes on the disk, and asks for the errors that a file system tells only when a file is closed. The file
  /// stays open and locked.
  std::error_code sync();
  void close();

 private:
  int descriptor_ = -1;
  bool is_locked_ = false;
};

/// It runs from its construction on.
class Stopwatch {
 public:
  /// Milliseconds so far.
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace alcove
