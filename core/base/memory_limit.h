// How much memory the process may still take, after the limits of containers, systemd and batch systems.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace alcove {

constexpr std::uint64_t kMebibyte = 1 << 20;  // bytes
constexpr std::uint64_t kNoMemoryLimit = std::numeric_limits<std::uint64_t>::max();

/// The bytes that the control groups of this process leave it: the least that is left in its own group or in any group
/// above it. kNoMemoryLimit where there is no limit, or none that can be read. Both versions of control groups are
/// read. `root` is a folder that stands for the whole file system.
std::uint64_t memory_left_in_groups(const std::string& root = "/");

/// The bytes that the machine can still give away, after Linux's own estimate (MemAvailable of /proc/meminfo).
std::uint64_t memory_left_on_machine(const std::string& root = "/");

/// The bytes of memory on this node that a Slurm job has asked for, by the variables of its environment. Slurm need not
/// enforce them by control groups, and ends jobs that take more all the same.
std::uint64_t memory_of_slurm_job();

/// The least of the three.
std::uint64_t free_memory();

}  // namespace alcove
