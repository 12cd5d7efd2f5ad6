// Which pixels have an estimate of their own, by the lattice of its spacing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/test.h"

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

}  // namespace alcove::test
