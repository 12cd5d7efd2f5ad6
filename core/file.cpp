// Files as wholes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "core/error.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

/// A file under a name of its own that vanishes unless it is renamed.
class Temporary {
 public:
  /// Hidden and without the ending of an image, so that folder watchers pass it by; not to be guessed.
  explicit Temporary(const std::string& target)
      : target_(target),
        path_(folder_of(target) / fmt::format(".alcove-{}-{:08x}.tmp", ::getpid(), std::random_device()())),
        descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) give_up("make a temporary file for");
  }
  ~Temporary() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_ && !path_.empty()) ::unlink(path_.c_str());
  }
  Temporary(const Temporary&) = delete;

  void write(std::span<const char> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) give_up("write");
      bytes = bytes.subspan(std::size_t(written));
    }
  }

  void rename_to_target() {
    const int closed = ::close(std::exchange(descriptor_, -1));
    if (closed != 0) give_up("write");
    if (::rename(path_.c_str(), target_.c_str()) != 0) give_up("rename the finished file to");
    renamed_ = true;
  }

 private:
  [[noreturn]] void give_up(const char* what) const {
    const int error = errno;
    fail(ErrorKind::output, "{}: could not {} it: {}", target_, what, std::strerror(error));
  }

  std::string target_;
  fs::path path_;
  int descriptor_;
  bool renamed_ = false;
};

}  // namespace

void require_readable(const std::string& path, const char* what, const char* option) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) fail(ErrorKind::input, "{}: {} file not found ({})", path, what, option);
  if (fs::is_directory(status)) fail(ErrorKind::input, "{}: is a folder; {} takes a {} file", path, option, what);
  if (::access(path.c_str(), R_OK) != 0) fail(ErrorKind::input, "{}: {} file cannot be read: {}", path, what, std::strerror(errno));
}

std::string read_text(const std::string& path, const char* what, const char* option) {
  require_readable(path, what, option);
  std::ifstream file(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  if (file.bad()) fail(ErrorKind::input, "{}: {} file cannot be read", path, what);
  return text;
}

void require_writable(const std::string& path, const char* option) {
  std::error_code error;
  const fs::path folder = folder_of(path);
  const auto folder_status = fs::status(folder, error);
  if (!fs::exists(folder_status)) fail(ErrorKind::output, "{}: its folder {} does not exist ({})", path, folder.string(), option);
  if (!fs::is_directory(folder_status)) fail(ErrorKind::output, "{}: {} is not a folder ({})", path, folder.string(), option);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail(ErrorKind::output, "{}: its folder cannot be written: {} ({})", path, std::strerror(errno), option);
  const auto status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) fail(ErrorKind::output, "{}: is no regular file; {} names the file to write", path, option);
}

void write_whole(const std::string& path, std::span<const char> bytes) {
  // A link stays a link: what it names is replaced.
  std::error_code error;
  const fs::path target = fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : fs::path(path);
  Temporary file(error ? path : target.string());
  file.write(bytes);
  file.rename_to_target();
}

}  // namespace alcove
