// Declarations that only the sources of core/formats/exr* share.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImathBox.h>
#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <cstdint>
#include <exception>
#include <functional>
#include <iosfwd>
#include <string>

#include "core/formats/exr.h"

namespace alcove {

class ExrAttributes {
 public:
  Imf::Header header;
};

inline Window window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1};
}

inline Imath::Box2i box_of(const Window& window) {
  return {{window.x, window.y}, {window.x + window.width - 1, window.y + window.height - 1}};
}

inline SampleType sample_type_of(Imf::PixelType type) {
  return type == Imf::HALF    ? SampleType::half_float
         : type == Imf::FLOAT ? SampleType::single_float
                              : SampleType::integer;
}

/// The bytes of a sample in the file.
inline std::size_t bytes_of(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

/// Gives OpenEXR's description of an error on one line.
std::string one_line(const std::exception& error);

/// Whether an attribute describes the storage or the channels of the input, which differ in an output.
bool describes_storage(const std::string& name);

/// Checks an EXR's header before OpenEXR believes it: walks the attributes of all parts without allocating by their
/// sizes. The file stands at its beginning. Fails with ErrorKind::input if an attribute is larger than the file, if all
/// of them are longer than 32 MiB, or if a part has more lines or tiles than the file has room for their offsets, since
/// OpenEXR would allocate for both. Gives the bytes of the header; the tables of chunks stand behind it.
std::uint64_t require_sane_header(std::istream& file, const std::string& path, const char* option);

/// The number of OpenEXR's threads for so many pieces, at most `most` at once; 1: only the caller's
/// thread.
std::size_t exr_workers(std::size_t pieces, std::size_t most);

/// Calls work(piece, worker) for all numbers below `pieces`, the lower ones first, on so many of OpenEXR's threads, or
/// on the caller's if `workers` is 1. `worker` is the number of the thread. If a piece fails, no other one is begun,
/// and the failure of the lowest piece is thrown: so a damaged file ends the same on any number of threads.
void on_exr_threads(std::size_t pieces, std::size_t workers,
                    const std::function<void(std::size_t piece, std::size_t worker)>& work);

}  // namespace alcove
