// Files in the making: one owner, on the disk before they have their names, and with the permissions of what they
// replace.
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

#include "core/base/file.h"
#include "tests/support/program.h"

namespace {

/// What this program asked of the disk, in order.
std::vector<std::string>& disk_calls() {
  static std::vector<std::string> calls;
  return calls;
}

/// How many of the next calls of fsync() a signal interrupts.
int interruptions = 0;

}  // namespace

// These stand before the C library's own functions of their names.
extern "C" int fsync(int descriptor) {
  struct stat status {};
  ::fstat(descriptor, &status);
  disk_calls().emplace_back(S_ISDIR(status.st_mode) ? "sync folder" : "sync file");
  if (interruptions > 0) {
    interruptions--;
    errno = EINTR;
    return -1;
  }
  return int(::syscall(SYS_fsync, descriptor));
}
extern "C" int rename(const char* from, const char* to) noexcept {
  disk_calls().emplace_back("rename");
  return int(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace alcove::new_file_test {
namespace {

using namespace test;

class NewFiles : public testing::Test {
 protected:
  TemporaryFolder folder;
  const std::string path = folder / "a.exr";
};

TEST_F(NewFiles, a_file_in_the_making_has_one_owner) {
  EXPECT_FALSE(std::is_copy_constructible_v<NewFile>);
  EXPECT_FALSE(std::is_copy_assignable_v<NewFile>) << "both would close one descriptor";
  NewFile first(path);
  first.write_at(0, std::string("whole"));
  NewFile second = std::move(first);
  EXPECT_THAT(names_in(folder.path()), SizeIs(1));
  second.commit();
  EXPECT_EQ(read_bytes(path), "whole");
}

TEST_F(NewFiles, that_are_replaced_leave_their_permissions_and_owner) {
  const mode_t before = ::umask(0022);
  for (const mode_t mode : {0664, 0600, 0444}) {
    write_bytes(path, "before");
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
    if (::geteuid() == 0) ASSERT_EQ(::chown(path.c_str(), 65534, 65533), 0);
    write_whole(path, std::string("after"));
    struct stat status {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, mode);
    if (::geteuid() == 0) EXPECT_EQ(std::pair(status.st_uid, status.st_gid), std::pair(uid_t(65534), gid_t(65533)));
    EXPECT_EQ(read_bytes(path), "after");
  }
  ::umask(before);
}

TEST_F(NewFiles, whose_owner_cannot_be_kept_let_nobody_else_in) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root makes files of others";
  fs::permissions(folder.path(), fs::perms(0777));
  write_bytes(path, "before");
  ASSERT_EQ(::chown(path.c_str(), 0, 65533), 0);
  ASSERT_EQ(::chmod(path.c_str(), 06664), 0);
  ASSERT_EQ(::setresuid(65534, 65534, 0), 0);
  EXPECT_NO_THROW(write_whole(path, std::string("after")));
  ASSERT_EQ(::setresuid(0, 0, 0), 0);
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_uid, 65534u);
  EXPECT_EQ(status.st_mode & 07777, 0604u) << "the permissions of the group were for another group";
}

TEST_F(NewFiles, are_on_the_disk_before_they_have_their_names_and_their_names_after) {
  disk_calls().clear();
  write_whole(path, std::string("whole"));
  EXPECT_THAT(disk_calls(), ElementsAre("sync file", "rename", "sync folder"));
}

TEST_F(NewFiles, are_whole_though_signals_interrupt_the_wait_for_the_disk) {
  disk_calls().clear();
  interruptions = 2;
  EXPECT_NO_THROW(write_whole(path, std::string("whole")));
  EXPECT_THAT(disk_calls(), ElementsAre("sync file", "sync file", "sync file", "rename", "sync folder"));
  EXPECT_EQ(read_bytes(path), "whole");
}

}  // namespace
}  // namespace alcove::new_file_test
