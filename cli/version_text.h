// What `alcove --version` prints.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace alcove {

/// The name with the version; how it was built; with which libraries: a line each.
std::string version_text();

}  // namespace alcove
