// Runs the built program as a shell would, and keeps the files of a test in a folder that vanishes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/test.h"

namespace alcove::test {

/// What a program left behind when it ended.
struct Finished {
  int code;  // exit code; 128 + number after a signal; -1 when it was stopped for taking too long
  std::string out, err;
  long peak_mib = 0;  // of memory, at any moment
};
std::ostream& operator<<(std::ostream& stream, const Finished& finished);

/// How the program is started.
struct Launch {
  std::string folder = "/";  // working directory; not the test's own, so that nothing depends on it
  // to set, or to remove where there is no value; all else is inherited
  std::map<std::string, std::optional<std::string>> environment = {};
  std::string preload = {};  // a library that stands before all others
  double seconds = 300;      // then it is killed; under sanitizers, beside other work, frames take many
  std::string program = ALCOVE_PROGRAM;
  // files that stand for the standard output and the standard error, instead of Finished's texts
  std::string out = {}, err = {};
  std::function<void(int)> meanwhile = {};  // called with its process id while it runs
};

/// The words of a command line.
using Options = std::vector<std::string>;

/// Runs the program with these arguments and waits for its end. It finds the presets of the project unless the
/// launch says otherwise, and computes on the device that ALCOVE_TEST_DEVICE names unless the arguments do. What
/// slow machines alone print, how long a frame takes, is left out of Finished::err.
Finished run_program(const Options& arguments, const Launch& launch = {});
/// The same of a run that must succeed.
Finished run_well(const Options& arguments, const Launch& launch = {});

/// The words of a text with blanks between them.
Options typed(const std::string& text);
Options joined(Options options, const Options& more);

/// It must have ended with this code and, but for the summary of a sequence, one line on stderr that holds all of these
/// texts.
void expect_refused(const Finished& finished, int code, const Options& texts);

std::vector<std::string> lines_of(const std::string& text);

/// A folder under the system's temporary folder; it goes with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// Every name below a folder, hidden ones too, sorted.
std::vector<std::string> names_in(const std::string& folder);

std::string read_bytes(const std::string& path);
void write_bytes(const std::string& path, const std::string& bytes);

/// The data of a report page as a browser reads it: up to the first closing tag.
std::string data_of_page(const std::string& html);
/// The same of the page in a file.
json report_in(const std::string& page);

/// A file system of its own in memory at `folder`, seen by this process and its children only, so that it goes with
/// them. Options as for mount -o: "size=64k". False where this process may not mount.
bool mount_memory(const std::string& folder, const std::string& options);
/// Makes what mount_memory() has mounted there read-only.
bool make_read_only(const std::string& folder);
void unmount(const std::string& folder);

}  // namespace alcove::test
