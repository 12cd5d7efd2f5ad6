// Stands between Alcove and the Vulkan loader: shows another device than there is, and notes what the driver is told.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace alcove::test {

/// Linked into a test program it takes the place of the loader's functions. Preloaded into another program it has
/// memory of its own.
struct FakeDriver {
  // What it pretends.
  bool has_own_memory = false;         // as a discrete GPU: see kOwnMemory in the source
  bool is_discrete = false;            // by its type and driver
  bool is_portable = false;            // has VK_KHR_portability_subset
  std::uint32_t most_allocations = 0;  // 0: as many as the driver says
  std::uint32_t most_texels = 0;       // of a buffer; 0: as many as the driver says
  std::string version = {};            // of the driver, as "Mesa 25.0.7"; empty: its own
  bool hangs = false;                  // no submission ends
  int failing_submission = 0;          // from now on; 0: none
  bool lists_no_extensions = false;    // of its device: the call fails
  std::uint64_t slow_ticks = 0;        // that every third submission's dispatches take, the others 1; 0: the real ones

  // What it was told.
  std::uint32_t instance_flags = 0;
  std::vector<std::string> instance_extensions = {}, device_extensions = {};
  bool is_robust = false;
  std::vector<std::uint32_t> mapped_types = {};          // types of memory that were mapped
  std::vector<std::vector<std::uint32_t>> modules = {};  // SPIR-V
  int idle_waits = 0, submissions = 0, queries = 0, slices = 0, allocations = 0, live_allocations = 0,
      live_instances = 0;
};

FakeDriver& fake_driver();

}  // namespace alcove::test
