// A look at an EXR's header before OpenEXR believes what it says.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

namespace alcove {

/// Walks the attributes of all parts, allocating nothing by their sizes. The file stands at its beginning. Fails with
/// ErrorKind::input where an attribute is larger than the file, all of them are longer than 32 MiB, or a part has more
/// lines or tiles than the file has room for their offsets: OpenEXR would make room for both. Gives the bytes of the
/// header, behind which the tables of chunks stand.
std::uint64_t require_sane_header(std::istream& file, const std::string& path, const char* option);

}  // namespace alcove
