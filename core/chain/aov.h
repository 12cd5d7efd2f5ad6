// The AOVs that Alcove writes: ONE table of what each is called, its channels, and where its planes come from.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"

namespace alcove {

namespace gpu {
class Buffer;
}
struct FrameOutputs;  // core/chain/chain.h

/// A row of the table.
struct Aov {
  std::string name;                    // as --aov takes it
  std::vector<std::string> channels;   // in the file; one a plane, or all from the only plane
  gpu::Buffer* FrameOutputs::*planes;  // where the chain leaves them
  bool is_float = false;               // whatever --type says: half would lose what it is for
};
std::span<const Aov> aov_table();
std::vector<std::string> aov_names();

/// The rows that the settings ask for, each once, in their order. Fails with ErrorKind::usage on a name that is not in
/// the table, listing what is.
std::vector<Aov> aovs_of(const OutputSettings& settings);

/// The channels of an AOV that has so many planes: ao-scales has one a radius, scale1.Y of the smallest.
std::vector<std::string> channels_of(const Aov& aov, std::size_t planes);

/// Whether one of them lies there.
bool wants(const OutputSettings& settings, gpu::Buffer* FrameOutputs::*planes);

}  // namespace alcove
