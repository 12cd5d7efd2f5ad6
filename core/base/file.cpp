// Files as wholes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string_view>

#include "core/base/error.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinishedPrefix = ".alcove-";
constexpr const char* kUnfinishedSuffix = ".tmp";

/// Takes the lock that says "somebody is writing this". On file systems without locks nothing is locked.
bool lock(int descriptor, bool wait) {
  while (::flock(descriptor, LOCK_EX | (wait ? 0 : LOCK_NB)) != 0)
    if (errno != EINTR) return wait && errno != EWOULDBLOCK;
  return true;
}

/// Whether a name is one that NewFile gives: a process, eight digits.
bool is_unfinished(std::string_view name) {
  if (!name.starts_with(kUnfinishedPrefix) || !name.ends_with(kUnfinishedSuffix)) return false;
  name.remove_prefix(std::string_view(kUnfinishedPrefix).size());
  name.remove_suffix(std::string_view(kUnfinishedSuffix).size());
  const std::size_t dash = name.find('-');
  const auto all_of = [](std::string_view text, const char* digits) {
    return !text.empty() && text.find_first_not_of(digits) == text.npos;
  };
  return dash != name.npos && all_of(name.substr(0, dash), "0123456789") && name.size() - dash == 9 &&
         all_of(name.substr(dash + 1), "0123456789abcdef");
}

bool is_removed(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && status.st_nlink == 0;
}

}  // namespace

void require_readable(const std::string& path, const char* what, const char* option) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::none)
    fail(ErrorKind::input, "{}: {} file cannot be reached: {} ({})", path, what, error.message(), option);
  if (!fs::exists(status)) fail(ErrorKind::input, "{}: {} file not found ({})", path, what, option);
  if (fs::is_directory(status)) fail(ErrorKind::input, "{}: is a folder; {} takes a {} file", path, option, what);
  if (::access(path.c_str(), R_OK) != 0)
    fail(ErrorKind::input, "{}: {} file cannot be read: {} ({})", path, what, std::strerror(errno), option);
}

std::string read_rest(std::istream& stream) {
  // Block by block: an iterator over the stream would throw the library's own exception where the disk fails.
  std::string text;
  std::array<char, 1 << 14> block;
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    text.append(block.data(), std::size_t(stream.gcount()));
  return text;
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
  // What stands there is renamed over: a device's name, such as /dev/stdout, would be gone for everybody.
  const std::string whole = fs::canonical(folder, error).string() + "/";
  const bool is_systems = std::ranges::any_of(std::array{"/dev/", "/proc/", "/sys/"},
                                              [&](const char* root) { return whole.starts_with(root); });
  if (is_systems && !whole.starts_with("/dev/shm/"))
    fail(ErrorKind::output, "{}: {} is no place for files; {} names the file to write", path, folder.string(), option);
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    fail(ErrorKind::output, "{}: its folder cannot be written: {} ({})", path, std::strerror(errno), option);
  const auto status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    fail(ErrorKind::output, "{}: is no regular file; {} names the file to write", path, option);
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path whole_a = fs::weakly_canonical(a, error),
                 whole_b = error ? fs::path() : fs::weakly_canonical(b, error);
  return error ? a == b : whole_a == whole_b;
}

void require_no_input(const std::string& path, const char* option, std::span<const std::string> inputs) {
  for (const auto& input : inputs)
    if (!input.empty() && same_file(input, path))
      fail(ErrorKind::usage, "{}: {} would overwrite an input", path, option);
}

NewFile::NewFile(const std::string& path) : target_(path) {
  // Whoever cleans up may take the file in the moment before it is locked.
  do {
    if (descriptor_ >= 0) ::close(descriptor_);
    temporary_ = (fs::path(folder_of(target_)) / fmt::format("{}{}-{:08x}{}", kUnfinishedPrefix, ::getpid(),
                                                             std::random_device()(), kUnfinishedSuffix))
                     .string();
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) give_up("make a temporary file for", errno);
  } while (lock(descriptor_, true) && is_removed(descriptor_));
}

NewFile::~NewFile() {
  if (descriptor_ < 0) return;
  ::unlink(temporary_.c_str());
  ::close(descriptor_);
}

void NewFile::write_at(std::uint64_t offset, std::span<const char> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), off_t(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) give_up("write", written < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(std::size_t(written));
    offset += std::uint64_t(written);
  }
}

void NewFile::commit() {
  // What a file system reports only when a file is closed must be known before it has its name; the lock stays with the
  // second descriptor.
  const int second = ::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);
  if (second < 0 || ::close(std::exchange(descriptor_, second)) != 0) give_up("write", errno);
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) give_up("rename the finished file to", errno);
  ::close(std::exchange(descriptor_, -1));
}

void NewFile::give_up(const char* what, int error) const {
  fail(ErrorKind::output, "{}: could not {} it: {}", target_, what, std::strerror(error));
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
    const int descriptor = ::open(entry->path().c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) continue;
    removed += lock(descriptor, false) && ::unlink(entry->path().c_str()) == 0;
    ::close(descriptor);
  }
  return removed;
}

std::string folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

}  // namespace alcove
