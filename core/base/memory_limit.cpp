// Reads what Linux tells of memory in /proc and in the mounted hierarchies of control groups.
// SPDX-License-Identifier: BSD-3-Clause
//
// Sources: Linux's Documentation/admin-guide/cgroup-v2.rst ("Memory Interface Files") and cgroup-v1/memory.rst, the
// manual pages cgroups(7) and proc_pid_mountinfo(5), and sbatch(1) for Slurm's variables.
#include "core/base/system.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "core/base/text.h"

namespace alcove {
namespace {

/// What the files of one version of control groups are called.
struct GroupFiles {
  std::vector<const char*> limits;  // each a number of bytes, or "max"
  const char* usage;
  std::vector<std::string> caches;  // of memory.stat: what is kept of files, which goes where memory is short
};
const GroupFiles kVersion1{
    {"memory.limit_in_bytes"}, "memory.usage_in_bytes", {"total_inactive_file", "total_active_file"}};
// Above memory.high processes are slowed down until they stand still.
const GroupFiles kVersion2{{"memory.max", "memory.high"}, "memory.current", {"inactive_file", "active_file"}};

std::optional<std::uint64_t> number_in(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

/// The only number in a file; nothing where there is none, as in "max".
std::optional<std::uint64_t> number_of_file(const std::string& path) {
  std::ifstream file(path);
  std::string word;
  return file >> word ? number_in(word) : std::nullopt;
}

/// The sum of the numbers behind some words at the beginnings of a file's lines; nothing where there is none of them.
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

/// What is left in one group, whatever holds above it.
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

/// A hierarchy of control groups that is mounted: which of its groups is seen at which folder.
struct GroupMount {
  std::string group, folder;
  bool is_version_2 = false;
};

/// mountinfo writes spaces, tabs, line ends and backslashes of names as three octal digits.
std::string unescaped(const std::string& text) {
  const auto is_octal = [](char c) { return c >= '0' && c <= '7'; };
  std::string plain;
  for (std::size_t i = 0; i < text.size(); i++) {
    const bool is_escape = text[i] == '\\' && i + 3 < text.size() && is_octal(text[i + 1]) && is_octal(text[i + 2]) &&
                           is_octal(text[i + 3]);
    if (is_escape) {
      plain += char((text[i + 1] - '0') * 64 + (text[i + 2] - '0') * 8 + (text[i + 3] - '0'));
      i += 3;
    } else {
      plain += text[i];
    }
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

/// The least that is left in a group and in all that are above it and can be seen.
std::uint64_t left_upwards(const std::string& root, const GroupMount& mount, const std::string& group) {
  // A container may see its own group as the top of the hierarchy, or a path that leads out of what it sees.
  std::string below = group;
  const std::string top = mount.group == "/" ? "" : mount.group;
  if (below == top || below.starts_with(top + "/"))
    below = below.substr(top.size());
  else
    below.clear();
  if (below.find("/..") != below.npos) below.clear();
  while (below.ends_with('/')) below.pop_back();

  const GroupFiles& files = mount.is_version_2 ? kVersion2 : kVersion1;
  std::uint64_t left = kNoMemoryLimit;
  while (true) {
    left = std::min(left, left_in_group(root + mount.folder + below, files));
    if (below.empty()) return left;
    below.resize(below.rfind('/') == below.npos ? 0 : below.rfind('/'));
  }
}

/// A number that a variable of the environment holds; nothing where it holds none, or one beyond all machines.
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
  std::uint64_t left = kNoMemoryLimit;
  // A line is "ID:CONTROLLERS:GROUP"; version 2 names no controllers.
  for (std::string line; std::getline(file, line);) {
    const std::size_t first = line.find(':'), second = first == line.npos ? first : line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    if (!controllers.empty() && !is_in_list("memory", controllers)) continue;
    for (const auto& mount : mounts)
      if (mount.is_version_2 == controllers.empty()) left = std::min(left, left_upwards(root, mount, group));
  }
  return left;
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
