// Which words of a command line are inputs, so that `alcove frame.exr` is `alcove run frame.exr`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace alcove {

/// Whether a word names an input: a file that is there, a name that ends as pictures do, or a pattern of such names.
bool names_input(const std::string& word);

}  // namespace alcove
