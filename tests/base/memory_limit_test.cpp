// Memory limits of control groups, read from folders that look like /proc and /sys/fs/cgroup.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/system.h"

#include "tests/support/program.h"

namespace alcove::memory_limit_test {
namespace {

using namespace test;

constexpr std::uint64_t kGiB = 1ull << 30;
const std::string kMount2 = "35 24 0:30 / /sys/fs/cgroup rw,nosuid - cgroup2 cgroup2 rw,nsdelegate\n";
const std::string kMount1 =
    "31 23 0:28 / /sys/fs/cgroup rw,relatime - tmpfs tmpfs rw,mode=755\n"
    "33 31 0:30 / /sys/fs/cgroup/cpuset rw,relatime shared:9 - cgroup cgroup rw,cpuset\n"
    "34 31 0:32 / /sys/fs/cgroup/memory rw,relatime shared:10 master:2 - cgroup cgroup rw,memory\n";

class Groups : public testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) const {
    fs::create_directories(fs::path(folder / path).parent_path());
    write_bytes(folder / path, text);
  }
  void write_group(const std::string& group, const std::string& max, const std::string& current) const {
    write("sys/fs/cgroup" + group + "/memory.max", max + "\n");
    write("sys/fs/cgroup" + group + "/memory.current", current + "\n");
  }
  void write_group_1(const std::string& group, const std::string& limit, const std::string& usage) const {
    write("sys/fs/cgroup/memory" + group + "/memory.limit_in_bytes", limit + "\n");
    write("sys/fs/cgroup/memory" + group + "/memory.usage_in_bytes", usage + "\n");
  }
  void write_process(const std::string& groups, const std::string& mounts) const {
    write("proc/self/cgroup", groups);
    write("proc/self/mountinfo", "23 1 8:1 / / rw - ext4 /dev/sda rw\n" + mounts);
  }
  std::uint64_t left() const { return memory_left_in_groups(folder.path()); }

  TemporaryFolder folder;
};

TEST_F(Groups, of_version_2_leave_their_limit_less_what_is_taken) {
  write_process("0::/system.slice/slurmstepd.scope/job_7/step_0/user/task_0\n", kMount2);
  write_group("/system.slice/slurmstepd.scope/job_7/step_0/user/task_0", std::to_string(8 * kGiB),
              std::to_string(3 * kGiB));
  EXPECT_EQ(left(), 5 * kGiB);
}

TEST_F(Groups, above_the_own_one_count_and_the_tightest_decides) {
  write_process("0::/farm/job/step/task\n", kMount2);
  write_group("/farm", std::to_string(64 * kGiB), std::to_string(30 * kGiB));
  write_group("/farm/job", std::to_string(8 * kGiB), std::to_string(2 * kGiB));
  write_group("/farm/job/step", "max", std::to_string(2 * kGiB));
  write_group("/farm/job/step/task", std::to_string(16 * kGiB), std::to_string(kGiB));
  EXPECT_EQ(left(), 6 * kGiB) << "of the job, two above";
  write_group("/farm", std::to_string(64 * kGiB), std::to_string(60 * kGiB));
  EXPECT_EQ(left(), 4 * kGiB) << "of the whole farm: others have taken the rest";
}

TEST_F(Groups, that_slow_down_before_they_are_full_leave_that_much) {
  write_process("0::/user.slice\n", kMount2);
  write_group("/user.slice", std::to_string(8 * kGiB), "0");
  write("sys/fs/cgroup/user.slice/memory.high", std::to_string(6 * kGiB));
  EXPECT_EQ(left(), 6 * kGiB);
}

TEST_F(Groups, do_not_count_what_is_kept_of_files) {
  write_process("0::/job\n", kMount2);
  write_group("/job", std::to_string(8 * kGiB), std::to_string(7 * kGiB));
  write("sys/fs/cgroup/job/memory.stat",
        "anon 1073741824\nfile 6442450944\ninactive_file 4294967296\nactive_file 1073741824\n");
  EXPECT_EQ(left(), 6 * kGiB) << "5 of the 7 GiB go where memory is short";
}

TEST_F(Groups, of_version_1_are_found_by_their_mount) {
  write_process("9:cpuset:/other\n4:memory:/slurm/uid_0/job_7/step_batch\n", kMount1);
  write_group_1("", "9223372036854771712", std::to_string(100 * kGiB));
  write_group_1("/slurm/uid_0/job_7", std::to_string(8 * kGiB), std::to_string(kGiB));
  write_group_1("/slurm/uid_0/job_7/step_batch", "9223372036854771712", std::to_string(kGiB));
  write_group_1("/other", std::to_string(kGiB), "0");
  EXPECT_EQ(left(), 7 * kGiB);
  write("sys/fs/cgroup/memory/slurm/uid_0/job_7/memory.stat", "cache 5\ntotal_inactive_file 536870912\n");
  EXPECT_EQ(left(), 7 * kGiB + kGiB / 2);
}

TEST_F(Groups, of_both_versions_side_by_side_both_count) {
  write_process("4:cpu,memory:/job\n0::/user\n",
                kMount1 + "41 31 0:38 / /sys/fs/cgroup/unified rw - cgroup2 cgroup2 rw\n");
  write_group_1("/job", std::to_string(8 * kGiB), "0");
  EXPECT_EQ(left(), 8 * kGiB);
  write("sys/fs/cgroup/unified/user/memory.max", std::to_string(2 * kGiB));
  EXPECT_EQ(left(), 2 * kGiB);
}

TEST_F(Groups, of_containers_are_seen_from_their_own_top) {
  // Docker with version 1: the mount shows the container's group at its top, while the process has its whole path.
  write_process("4:memory:/docker/abc/inner\n",
                "34 31 0:32 /docker/abc /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n");
  write_group_1("", std::to_string(4 * kGiB), "0");
  write_group_1("/inner", std::to_string(8 * kGiB), "0");
  EXPECT_EQ(left(), 4 * kGiB);
  write_group_1("/inner", std::to_string(2 * kGiB), "0");
  EXPECT_EQ(left(), 2 * kGiB);
  // A process that was moved out of what its name space shows.
  write_process("0::/../../other\n", kMount2);
  write_group("", std::to_string(3 * kGiB), "0");
  EXPECT_EQ(left(), 3 * kGiB);
}

TEST_F(Groups, at_places_with_spaces_are_found) {
  write_process("0::/job\n", "35 24 0:30 / /my\\040groups rw - cgroup2 cgroup2 rw\n");
  write("my groups/job/memory.max", std::to_string(kGiB));
  EXPECT_EQ(left(), kGiB);
}

TEST_F(Groups, that_have_taken_more_than_they_may_leave_nothing) {
  write_process("0::/job\n", kMount2);
  write_group("/job", std::to_string(kGiB), std::to_string(2 * kGiB));
  EXPECT_EQ(left(), 0u);
}

TEST_F(Groups, that_say_nothing_set_no_limit) {
  EXPECT_EQ(left(), kNoMemoryLimit) << "no files at all";
  write_process("0::/job\n", kMount2);
  EXPECT_EQ(left(), kNoMemoryLimit) << "no limits";
  write_group("/job", "max", "5");
  EXPECT_EQ(left(), kNoMemoryLimit);
  for (const std::string garbage : {"", "-1", "12x", "99999999999999999999999", "\xff\xfe", "\n\n"}) {
    write_group("/job", garbage, "garbage");
    EXPECT_EQ(left(), kNoMemoryLimit) << garbage;
  }
  write_group("/job", std::to_string(kGiB), "garbage");
  EXPECT_EQ(left(), kGiB) << "of a usage that cannot be read nothing is known";
  for (const std::string garbage : {"", "x", ":", "::", "0:", "0::", "\x01:\x02:\x03", "0::job\n"}) {
    write_process(garbage, "- - cgroup2\n35 - cgroup2 cgroup2 rw\n \n");
    EXPECT_EQ(left(), kNoMemoryLimit) << garbage;
  }
}

TEST_F(Groups, without_a_limit_leave_what_the_machine_has) {
  EXPECT_EQ(memory_left_on_machine(folder.path()), kNoMemoryLimit);
  write("proc/meminfo", "MemTotal:       24684100 kB\nMemFree:        1 kB\nMemAvailable:   1048576 kB\n");
  EXPECT_EQ(memory_left_on_machine(folder.path()), kGiB);
}

TEST(Slurm, says_by_its_variables_what_a_job_asked_for) {
  const auto asked = [](const char* of_node, const char* of_core, const char* cores) {
    for (const auto& [name, value] :
         {std::pair("SLURM_MEM_PER_NODE", of_node), {"SLURM_MEM_PER_CPU", of_core}, {"SLURM_CPUS_ON_NODE", cores}}) {
      ::unsetenv(name);
      if (value) ::setenv(name, value, 1);
    }
    return memory_of_slurm_job();
  };
  EXPECT_EQ(asked("2048", nullptr, "4"), 2 * kGiB);
  EXPECT_EQ(asked(nullptr, "1024", "4"), 4 * kGiB);
  EXPECT_EQ(asked("0", nullptr, "4"), kNoMemoryLimit) << "all of the node";
  EXPECT_EQ(asked(nullptr, "1024", nullptr), kNoMemoryLimit);
  EXPECT_EQ(asked("many", "more", "most"), kNoMemoryLimit);
  EXPECT_EQ(asked("99999999999999999999", nullptr, nullptr), kNoMemoryLimit);
  EXPECT_EQ(asked("18446744073709551615", nullptr, nullptr), kNoMemoryLimit);
  EXPECT_EQ(asked(nullptr, nullptr, nullptr), kNoMemoryLimit);
}

}  // namespace
}  // namespace alcove::memory_limit_test
