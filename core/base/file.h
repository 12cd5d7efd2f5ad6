// Files as wholes: text is read, and bytes are written completely or not at all.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>

#include "core/base/system.h"

namespace alcove {

/// Fails with ErrorKind::input unless `path` is a readable file; `what` and `option` are for the message ("camera",
/// "--camera").
void require_readable(const std::string& path, const char* what, const char* option);

/// Reads a whole file. Fails with ErrorKind::input.
std::string read_text(const std::string& path, const char* what, const char* option);

/// Fails with ErrorKind::output unless a file can be made at `path`: its folder must exist and be writable, and only a
/// regular file may stand there. Call it before any work, so that a long job does not fail at its end.
void require_writable(const std::string& path, const char* option);

/// Fails as require_writable() does, but allows missing folders that can be made.
void require_makeable(const std::string& path, const char* option);

/// Makes the missing folders of a file's path. Fails with ErrorKind::output.
void make_folder_of(const std::string& path, const char* option);

/// A file, and the option that names it.
struct NamedFile {
  std::string option, path;
};

/// The files that a command reads and writes. A file is the same by every name, through dots and links, also where it
/// is not there yet.
class FileUses {
 public:
  void add_input(const NamedFile& file);
  /// Fails with ErrorKind::usage if the file is an input, or an output of another option or owner. `whose` stands
  /// behind the option in the message, such as " of frame 3".
  void add_output(const NamedFile& file, const std::string& whose = "");

 private:
  std::set<std::string> input_paths_;           // as they are spelled
  std::map<std::string, NamedFile> inputs_;     // by the file
  std::map<std::string, std::string> outputs_;  // by the file; option and owner
};

/// A file in the making. Its hidden name beside `path` does not end as images do, so that folder watchers pass it by.
/// It is locked for as long as its process lives. Unless it is committed, it vanishes, and the file at `path` stays as
/// it was. All failures are ErrorKind::output.
class NewFile {
 public:
  explicit NewFile(const std::string& path);
  ~NewFile();
  NewFile(NewFile&& other) noexcept = default;
  NewFile(const NewFile&) = delete;
  NewFile& operator=(NewFile&& other) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write_at(std::uint64_t offset, std::span<const char> bytes);
  /// Gives the file its name once its bytes are on the disk, so that after a loss of power it is whole or absent. The
  /// new file gets the permissions, owner and group of the file that it replaces, as far as this process may set them.
  /// A symbolic link at `path` is replaced, and its target stays as it was: nobody who can write into a folder can
  /// redirect an output. Links among the folders of the path are followed.
  void commit();
  /// The file's name until it is committed.
  const std::string& temporary() const { return temporary_; }

 private:
  [[noreturn]] void give_up(const char* what, const std::error_code& error) const;

  std::string target_, temporary_;
  LockedFile file_;
};

/// Writes a file at once, as NewFile does.
void write_whole(const std::string& path, std::span<const char> bytes);

/// Removes unfinished files of killed processes from a folder, and returns their number. Files of living processes
/// stay, whatever machine they run on. Only regular files are looked at: links are not followed, and pipes are not
/// waited for. Never fails: files that cannot be removed stay.
int remove_unfinished(const std::string& folder);

/// The folder of a file.
std::string folder_of(const std::string& path);
/// The part of a path before the file's name, as it is spelled, with the separator; "" if it names no folder.
std::string folder_prefix(const std::string& path);
/// Whether a path is on a share of Windows, "\\server\share\...". GCC 12 looks for it on the folder's drive.
bool is_on_share(const std::string& path);
/// A path that a text in a folder names: from there, unless it is whole.
std::string path_from(const std::string& folder, const std::string& path);

}  // namespace alcove
