// Which pixels have an estimate of their own, as the host reads it from the words of tiles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/chain/estimate/sites.h"
#include "core/gpu/recorder.h"

namespace alcove::test {

/// A coordinate in a period, also left of the first one.
inline int within(int x, int period) { return (x % period + period) % period; }

/// Whether a pixel lies on the lattice of a spacing; it counts from the display window's corner.
inline bool is_on_lattice(int x, int y, int spacing) {
  const int u = within(x, 4), v = within(y, 4);
  switch (spacing) {
    case 16: return u == 0 && v == 0;
    case 8: return u % 2 == 0 && v == 0;
    case 4: return u % 2 == 0 && v % 2 == 0;
    case 2: return (u + v) % 2 == 0;
    default: return true;
  }
}

/// The sites of a G-buffer.
struct SiteMap {
  std::vector<uint> rows;  // 8 words per tile, see kernels/base/tiles.glsl; none: every pixel is a site
  int tile_columns = 0;

  bool is_site(int x, int y) const {
    if (rows.empty()) return true;
    const int tile = y / kTile * tile_columns + x / kTile;
    return (rows[std::size_t(tile * kTile + y % kTile)] >> (24 + x % kTile) & 1u) != 0;
  }
};

/// Runs what is recorded, and reads the sites from the device. What was recorded is gone then, its buffers are not.
inline SiteMap map_of(gpu::Recorder& gpu, const GBuffer& gbuffer, const Sites& sites) {
  SiteMap map;
  if (!sites.rows) return map;
  gpu.download(*sites.rows);
  gpu.run();
  const auto rows = sites.rows->as<const uint>();
  map.rows.assign(rows.begin(), rows.end());
  map.tile_columns = (gbuffer.view.size.x + kTile - 1) / kTile;
  return map;
}

}  // namespace alcove::test
