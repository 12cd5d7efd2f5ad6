// Files as wholes: text is read, and bytes are written completely or not at all.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>

#include "core/base/system.h"

namespace alcove {

/// Fails with ErrorKind::input unless `path` is a readable file; `what` and `option` are for the message ("camera",
/// "--camera").
void require_readable(const std::string& path, const char* what, const char* option);

/// Reads what is left in a stream. Where it cannot be read to its end, the stream is bad() afterwards.
std::string read_rest(std::istream& stream);

/// Reads a whole file. Fails with ErrorKind::input.
std::string read_text(const std::string& path, const char* what, const char* option);

/// Fails with ErrorKind::output unless a file can be made at `path`: its folder exists and is writable, and nothing but
/// a regular file stands there. Called before any work, so that a long job does not fail at its end.
void require_writable(const std::string& path, const char* option);

/// Does the same for a file whose folders may be missing: they can be made.
void require_makeable(const std::string& path, const char* option);

/// Makes the folders that a file lies in, where they are missing. Fails with ErrorKind::output.
void make_folder_of(const std::string& path, const char* option);

/// Whether two names are, or would be, one file, whatever dots and links are in them.
bool same_file(const std::string& a, const std::string& b);

/// Fails with ErrorKind::usage where `path`, which is to be written, is one of the inputs. Empty names are none.
void require_no_input(const std::string& path, const char* option, std::span<const std::string> inputs);

/// A file in the making. It has a hidden name beside `path` that does not end as images do, so that folder watchers
/// pass it by, and a lock for as long as its process lives. Unless it is committed nothing of it is left, and what was
/// at `path` is as it was. All failures are ErrorKind::output.
class NewFile {
 public:
  explicit NewFile(const std::string& path);
  ~NewFile();
  NewFile(NewFile&& other) noexcept = default;
  NewFile(const NewFile&) = delete;
  NewFile& operator=(NewFile&& other) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write_at(std::uint64_t offset, std::span<const char> bytes);
  /// Gives the file its name once its bytes are on the disk, so that after a loss of power it is whole or not there. A
  /// file that is replaced leaves it its permissions, its owner and its group, as far as this process may set them. A
  /// symbolic link at `path` is replaced and what it names stays as it was, so that nobody who can write into a folder
  /// sends what is written there elsewhere; links among the folders of the path are followed.
  void commit();
  /// The name that it has until then.
  const std::string& temporary() const { return temporary_; }

 private:
  [[noreturn]] void give_up(const char* what, const std::error_code& error) const;

  std::string target_, temporary_;
  LockedFile file_;
};

/// Writes a file whose bytes are all there, as NewFile does.
void write_whole(const std::string& path, std::span<const char> bytes);

/// Removes the unfinished files that killed processes have left in a folder, and returns their number. Those of living
/// processes stay, whatever machine they run on. Only regular files are looked at: no link is followed, and no pipe is
/// waited for. Never fails: what cannot be removed stays.
int remove_unfinished(const std::string& folder);

/// The folder that a file lies in.
std::string folder_of(const std::string& path);
}  // namespace alcove
