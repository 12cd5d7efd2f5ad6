// Scan lines that ZIP or ZIPS has compressed, read by ourselves: OpenEXR finds and checks the chunks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfHeader.h>
#include <ImfInputPart.h>

#include <span>
#include <string>

namespace alcove {

/// The bytes of a row of all channels of a part whose channels are not subsampled.
std::size_t zip_row_bytes(const Imf::Header& header);

/// How many rows ZIP or ZIPS puts together.
int rows_of_zip_chunk(const Imf::Header& header);

/// A channel to read: as floats, or as it is stored.
struct ZipRead {
  std::string channel;
  void* to;
  bool as_floats = true;
};

/// Whether read_zip_rows() reads such a part, and OpenEXR need not.
bool is_zip_rows(const Imf::Header& header);

/// Reads `rows` rows of the part's data window, from the `first` one on, on as many of OpenEXR's threads as are
/// allowed, or on the caller's where that is none. The part has these channels. Fails with a std::exception where
/// chunks are missing or damaged.
void read_zip_rows(const Imf::InputPart& part, std::span<const ZipRead> reads, int first, int rows, int most_threads);

}  // namespace alcove
