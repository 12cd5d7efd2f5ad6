// The table of subcommands.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"

namespace alcove {

const std::vector<Subcommand>& subcommands() {
  static const std::vector<Subcommand> kTable{
      {"run", "compute ambient occlusion from a frame's depth and normals", run_command, describe_run},
      {"inspect", "describe a frame, its reading, and missing inputs", inspect_command, describe_inspect},
      {"wedge", "show a frame in many looks, with the command of each", wedge_command, describe_wedge},
      {"compare", "measure the error of a result against a reference", compare_command, describe_compare},
      {"bench", "measure device time against error", bench_command, describe_bench},
      {"presets", "list the presets, or print one", presets_command, describe_presets},
      {"devices", "list the Vulkan devices", devices_command, describe_devices},
      {"doctor", "print the facts for a bug report: devices, libraries, folders, memory", doctor_command,
       describe_doctor},
  };
  return kTable;
}

}  // namespace alcove
