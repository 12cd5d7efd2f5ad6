// posix_spawn with captured output, temporary folders, private mounts.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/program.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <ostream>
#include <sstream>
#include <system_error>

#include "tests/support/test.h"

namespace alcove::test {
namespace {

void require(bool condition, const char* what) {
  if (!condition) throw std::system_error(errno, std::generic_category(), what);
}

/// A file without a name that a child writes and we read.
class Capture {
 public:
  explicit Capture(const char* name) : descriptor_(::memfd_create(name, MFD_CLOEXEC)) {
    require(descriptor_ >= 0, "memfd_create");
  }
  ~Capture() { ::close(descriptor_); }
  Capture(const Capture&) = delete;
  int descriptor() const { return descriptor_; }
  std::string text() const {
    std::string text(std::size_t(::lseek(descriptor_, 0, SEEK_END)), '\0');
    require(::pread(descriptor_, text.data(), text.size(), 0) == ssize_t(text.size()), "pread");
    return text;
  }

 private:
  int descriptor_;
};

/// Our environment with the changes.
std::vector<std::string> environment_with(const Launch& launch) {
  auto changes = launch.environment;
  changes.try_emplace("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets");  // a build folder may lie anywhere
  if (!launch.preload.empty()) {
    changes["LD_PRELOAD"] = launch.preload;
    const char* before = std::getenv("ASAN_OPTIONS");
    // which asks to be the first itself
    changes["ASAN_OPTIONS"] = std::string(before ? before : "") + ":verify_asan_link_order=0";
  }
  std::vector<std::string> variables;
  for (char** variable = environ; *variable; variable++) {
    const std::string text = *variable;
    if (!changes.contains(text.substr(0, text.find('=')))) variables.push_back(text);
  }
  for (const auto& [name, value] : changes)
    if (value) variables.push_back(name + "=" + *value);
  return variables;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (auto& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// The arguments with the device that ALCOVE_TEST_DEVICE names, for commands that compute and where they name none
/// themselves.
std::vector<std::string> on_test_device(std::vector<std::string> arguments) {
  const char* device = std::getenv("ALCOVE_TEST_DEVICE");
  const bool computes = !arguments.empty() && (arguments[0] == "run" || arguments[0] == "bench");
  const auto names_one = [](const std::string& word) {
    return word.starts_with("--device") || word == "require-gpu=true";
  };
  if (device && *device && computes && std::ranges::none_of(arguments, names_one))
    arguments.insert(arguments.begin() + 1, {"--device", device});
  return arguments;
}

/// The exit code as a shell tells it; -1 when the child had to be killed. What it used goes into `usage`.
int wait_for(pid_t child, double seconds, rusage& usage) {
  const int descriptor = int(::syscall(SYS_pidfd_open, child, 0));
  require(descriptor >= 0, "pidfd_open");
  pollfd event{descriptor, POLLIN, 0};
  const bool ended = ::poll(&event, 1, int(1000 * seconds)) == 1;
  ::close(descriptor);
  if (!ended) ::kill(child, SIGKILL);
  int status = 0;
  require(::wait4(child, &status, 0, &usage) == child, "wait4");
  if (!ended) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// What was said, but for the lines that tell how long a frame takes: only slow machines print them.
std::string without_durations(const std::string& said) {
  std::string rest;
  for (std::size_t at = 0, end = 0; at < said.size(); at = end) {
    end = std::min(said.find('\n', at), said.size() - 1) + 1;
    const std::string line = said.substr(at, end - at);
    if (!line.ends_with(" so far\n") && line.find(" so far, part ") == line.npos) rest += line;
  }
  return rest;
}

}  // namespace

std::ostream& operator<<(std::ostream& stream, const Finished& finished) {
  return stream << "exit code " << finished.code << "\nstdout: " << finished.out << "\nstderr: " << finished.err;
}

Finished run_program(const Options& arguments, const Launch& launch) {
  const Capture out("stdout"), err("stderr");
  std::vector<std::string> words = on_test_device(arguments), variables = environment_with(launch);
  words.insert(words.begin(), launch.program);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", 0, 0);
  posix_spawn_file_actions_adddup2(&actions, out.descriptor(), 1);
  posix_spawn_file_actions_adddup2(&actions, err.descriptor(), 2);
  for (const auto& [number, path] : {std::pair(1, &launch.out), {2, &launch.err}})
    if (!path->empty()) posix_spawn_file_actions_addopen(&actions, number, path->c_str(), O_WRONLY, 0);
  posix_spawn_file_actions_addchdir_np(&actions, launch.folder.c_str());
  // The program gets the signals' defaults, also where nohup has started the tests.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t ending;
  sigemptyset(&ending);
  for (const int number : {SIGHUP, SIGINT, SIGTERM}) sigaddset(&ending, number);
  posix_spawnattr_setsigdefault(&attributes, &ending);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t child = -1;
  errno = ::posix_spawn(&child, launch.program.c_str(), &actions, &attributes, pointers_to(words).data(),
                        pointers_to(variables).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  require(errno == 0, launch.program.c_str());
  if (launch.meanwhile) launch.meanwhile(child);
  rusage usage{};
  const int code = wait_for(child, launch.seconds, usage);
  return {code, out.text(), without_durations(err.text()), usage.ru_maxrss >> 10};
}

Finished run_well(const Options& arguments, const Launch& launch) {
  Finished finished = run_program(arguments, launch);
  EXPECT_EQ(finished.code, 0) << testing::PrintToString(arguments) << finished;
  return finished;
}

Options typed(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

Options joined(Options options, const Options& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

void expect_refused(const Finished& finished, int code, const Options& texts) {
  EXPECT_EQ(finished.code, code) << finished;
  const auto is_summary = [](const std::string& line) {
    return line.find(" frames done, ") != line.npos || line.find(" frame done, ") != line.npos;
  };
  std::vector<std::string> lines = lines_of(finished.err);
  std::erase_if(lines, is_summary);
  EXPECT_EQ(lines.size(), 1) << finished;
  for (const auto& text : texts) EXPECT_THAT(finished.err, HasSubstr(text));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TemporaryFolder::TemporaryFolder() : path_((fs::temp_directory_path() / "alcove-test-XXXXXX").string()) {
  require(::mkdtemp(path_.data()) != nullptr, path_.c_str());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    names.push_back(entry.path().lexically_relative(folder).string());  // which may be gone by now
  std::ranges::sort(names);
  return names;
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) {
  if (fs::is_regular_file(path)) fs::remove(path);  // ext4 waits for the disk when a file is written over
  std::ofstream file(path, std::ios::binary);
  if (!file.write(bytes.data(), std::streamsize(bytes.size())).flush())
    throw std::runtime_error(path + ": cannot be written");
}

std::string data_of_page(const std::string& html) {
  const std::string open = "<script id=\"report\" type=\"application/json\">";
  const std::size_t begin = html.find(open);
  EXPECT_NE(begin, html.npos);
  return begin == html.npos ? "null"
                            : html.substr(begin + open.size(), html.find("</script>", begin) - begin - open.size());
}

json report_in(const std::string& page) { return json::parse(data_of_page(read_bytes(page))); }

bool mount_memory(const std::string& folder, const std::string& options) {
  static const bool is_private =  // mounts of a name space of our own: nobody else sees them, and they go with us
      ::unshare(CLONE_NEWNS) == 0 && ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
  return is_private && ::mount("alcove-test", folder.c_str(), "tmpfs", 0, options.c_str()) == 0;
}

bool make_read_only(const std::string& folder) {
  return ::mount(nullptr, folder.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) == 0;
}

void unmount(const std::string& folder) { ::umount2(folder.c_str(), MNT_DETACH); }

}  // namespace alcove::test
