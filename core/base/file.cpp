// Files as wholes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

/// Whether a name has the form that NewFile gives: a process number and eight digits.
bool is_unfinished(const std::string& name) {
  static const std::regex kName(R"(\.alcove-[0-9]+-[0-9a-f]{8}\.tmp)");
  return std::regex_match(name, kName);
}

/// An unused hidden name in a folder for a file in the making; remove_unfinished() knows its form.
std::string unfinished_name(const std::string& folder) {
  return (fs::path(folder) / fmt::format(".alcove-{}-{:08x}.tmp", process_id(), std::random_device()())).string();
}

constexpr bool kIsWindows = fs::path::preferred_separator == '\\';

/// Windows takes names for one that differ in case only, or in dots and blanks at their end.
std::string plain_name(std::string name) {
  if (!kIsWindows) return name;
  name.erase(name.find_last_not_of(". ") + 1);
  return lower_case(name);
}

/// The same text for every name of a file. One that is not there is known by the nearest folder that is, and its place
/// below it.
std::string identity_of(const std::string& path) {
  std::string id = file_id(path);
  if (!id.empty()) return id;
  std::error_code error;
  fs::path there = fs::weakly_canonical(path, error), below;
  if (error) return path;
  for (id = file_id(there.string()); id.empty() && there.has_relative_path(); id = file_id(there.string())) {
    below = plain_name(there.filename().string()) / below;
    there = folder_of(there.string());
  }
  return id + (below.empty() ? "" : "/" + below.string());
}

/// Reads the rest of a stream. If it cannot be read to its end, the stream is bad() afterwards.
std::string read_rest(std::istream& stream) {
  // The stream is read block by block, since an iterator would throw the library's own exception if the disk fails.
  std::string text;
  std::array<char, 1 << 14> block;
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    text.append(block.data(), std::size_t(stream.gcount()));
  return text;
}

/// Says what stands in a file's place where a repository keeps its content elsewhere; "" for a file itself.
std::string pointer_in(const std::string& path) {
  constexpr std::uintmax_t kLongestPointer = 1024;  // by the specification of Git LFS
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > kLongestPointer || error) return "";
  std::ifstream file(path, std::ios::binary);
  const std::string text = read_rest(file);
  if (text.starts_with("version https://git-lfs.github.com/")) return "a pointer of Git LFS: git lfs pull fetches it";
  return text.find("/annex/objects/") < 16 ? "a pointer of git-annex: git annex get fetches it" : "";
}

}  // namespace

void require_readable(const std::string& path, const char* what, const char* option) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::none)
    fail(ErrorKind::input, "{}: {} file cannot be reached: {} ({})", path, what, error.message(), option);
  if (!fs::exists(status)) fail(ErrorKind::input, "{}: {} file not found ({})", path, what, option);
  if (fs::is_directory(status)) fail(ErrorKind::input, "{}: is a folder; {} takes a {} file", path, option, what);
  if (const auto why = may_read(path))
    fail(ErrorKind::input, "{}: {} file cannot be read: {} ({})", path, what, why.message(), option);
  if (const std::string why = pointer_in(path); !why.empty())
    fail(ErrorKind::input, "{}: not the {} file itself but {} ({})", path, what, why, option);
}

std::string read_text(const std::string& path, const char* what, const char* option) {
  require_readable(path, what, option);
  std::ifstream file(path, std::ios::binary);
  std::string text = read_rest(file);
  if (file.bad()) fail(ErrorKind::input, "{}: {} file cannot be read to its end ({})", path, what, option);
  return text;
}

void require_writable(const std::string& path, const char* option) {
  std::error_code error;
  const fs::path folder = folder_of(path);
  const auto folder_status = fs::status(folder, error);
  if (folder_status.type() == fs::file_type::none)
    fail(ErrorKind::output, "{}: its folder cannot be reached: {} ({})", path, error.message(), option);
  if (!fs::exists(folder_status))
    fail(ErrorKind::output, "{}: its folder {} does not exist ({})", path, folder.string(), option);
  if (!fs::is_directory(folder_status))
    fail(ErrorKind::output, "{}: {} is not a folder ({})", path, folder.string(), option);
  // The output replaces whatever stands at its name. A device such as /dev/stdout would be gone for everybody.
  const std::string whole = fs::canonical(folder, error).string() + "/";
  const bool is_system_folder = std::ranges::any_of(std::array{"/dev/", "/proc/", "/sys/"},
                                                    [&](const char* root) { return whole.starts_with(root); });
  if (is_system_folder && !whole.starts_with("/dev/shm/"))
    fail(ErrorKind::output, "{}: {} is no place for files; {} names the file to write", path, folder.string(), option);
  if (const auto why = may_make_files_in(folder.string()))
    fail(ErrorKind::output, "{}: its folder cannot be written: {} ({})", path, why.message(), option);
  const auto status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    fail(ErrorKind::output, "{}: is no regular file; {} names the file to write", path, option);
  if (kIsWindows && fs::exists(status) && (status.permissions() & fs::perms::owner_write) == fs::perms::none)
    fail(ErrorKind::output, "{}: is read-only, so that Windows does not replace it ({})", path, option);
  if (fs::absolute(fs::path(path).filename(), error).string().starts_with(R"(\\.\)"))  // aux.exr, nul ...
    fail(ErrorKind::output, "{}: Windows keeps this name for a device; {} names the file to write", path, option);
}

void require_makeable(const std::string& path, const char* option) {
  std::error_code error;
  std::string first = path;  // the topmost missing folder, or the file itself
  while (fs::status(folder_of(first), error).type() == fs::file_type::not_found && folder_of(first) != first)
    first = folder_of(first);
  require_writable(first, option);
}

void make_folder_of(const std::string& path, const char* option) {
  std::error_code error;
  fs::create_directories(folder_of(path), error);
  if (error)
    fail(ErrorKind::output, "{}: its folder {} cannot be made: {} ({})", path, folder_of(path), error.message(),
         option);
}

void FileUses::add_input(const NamedFile& file) {
  // Frames share most of their inputs, and an identity takes a look at the disk.
  if (!file.path.empty() && input_paths_.insert(file.path).second) inputs_.emplace(identity_of(file.path), file);
}

void FileUses::add_output(const NamedFile& file, const std::string& whose) {
  const auto& [option, path] = file;
  if (path.empty()) return;
  const std::string identity = identity_of(path);
  if (const auto input = inputs_.find(identity); input != inputs_.end())
    fail(ErrorKind::usage, "{}: {}{} would overwrite an input: {} {}", path, option, whose, input->second.option,
         input->second.path);
  const auto& [known, is_new] = outputs_.emplace(identity, option + whose);
  if (!is_new && known->second != option + whose)
    fail(ErrorKind::usage, "{}: {} and {}{} name the same file", path, known->second, option, whose);
}

NewFile::NewFile(const std::string& path) : target_(path) {
  // A cleaning process may remove the file in the moment before it is locked.
  do {
    temporary_ = unfinished_name(folder_of(target_));
    if (const auto error = file_.make(temporary_)) give_up("make a temporary file for", error);
  } while (file_.is_removed());
}

NewFile::~NewFile() {
  if (!file_.is_open()) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void NewFile::write_at(std::uint64_t offset, std::span<const char> bytes) {
  if (const auto error = file_.write_at(offset, bytes)) give_up("write", error);
}

void NewFile::commit() {
  file_.take_after(target_);
  if (const auto error = file_.sync()) give_up("write", error);
  if (const auto error = rename_over(temporary_, target_)) give_up("rename the finished file to", error);
  file_.close();
  sync_folder(folder_of(target_));
}

void NewFile::give_up(const char* what, const std::error_code& error) const {
  fail(ErrorKind::output, "{}: could not {} it: {}", target_, what, error.message());
}

void write_whole(const std::string& path, std::span<const char> bytes) {
  NewFile file(path);
  file.write_at(0, bytes);
  file.commit();
}

int remove_unfinished(const std::string& folder) {
  int removed = 0;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!is_unfinished(name)) continue;
    if (!fs::is_regular_file(entry->symlink_status(error))) continue;
    LockedFile file;
    if (file.open_abandoned(entry->path().string())) continue;
    std::error_code kept;
    removed += fs::remove(entry->path(), kept);
  }
  return removed;
}

std::string folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

std::string folder_prefix(const std::string& path) {
  return path.substr(0, path.size() - fs::path(path).filename().string().size());
}

bool is_on_share(const std::string& path) { return kIsWindows && path.find_first_not_of("/\\") == 2; }

std::string path_from(const std::string& folder, const std::string& path) {
  return is_on_share(path) ? path : (fs::path(folder) / path).string();
}

}  // namespace alcove
