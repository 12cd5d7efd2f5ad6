// Names of outputs: what they end in is what is written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace alcove {

/// Fails with ErrorKind::usage where a name ends as if the file were of another format than `format`, whose ending is
/// `ending`, ".exr" say. A name without an ending is as good, and behind the ending there may be a frame number or the
/// suffix of a file in the making: ao.exr.0001, ao.exr.tmp.
void require_ending(const std::string& path, const char* option, const char* ending, const char* format);

}  // namespace alcove
