// Reads the header of a single-part EXR byte by byte, so that what Alcove wrote is not judged by the library that wrote
// it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/test.h"

namespace alcove::test {

/// One attribute as it stands in the file.
struct HeaderAttribute {
  std::string type, bytes;
  bool operator==(const HeaderAttribute&) const = default;
};
using ExrHeader = std::map<std::string, HeaderAttribute>;

/// The attributes by name. Throws std::runtime_error on anything but a whole header of a single-part file.
ExrHeader read_header(const std::string& path);

/// One channel of the attribute `channels`.
struct HeaderChannel {
  std::string name;
  int type;  // 0: integer, 1: half, 2: float
  bool operator==(const HeaderChannel&) const = default;
};
std::vector<HeaderChannel> channels_in(const ExrHeader& header);

/// The value of a string attribute; "(none)" where there is no such attribute.
std::string text_in(const ExrHeader& header, const std::string& name);

}  // namespace alcove::test
