// Scan lines that ZIP or ZIPS has compressed, read by ourselves: OpenEXR finds and checks the chunks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfHeader.h>
#include <ImfInputPart.h>

#include <span>

#include "core/formats/exr.h"

namespace alcove {

/// The bytes of a row of all channels of a part whose channels are not subsampled.
std::size_t zip_row_bytes(const Imf::Header& header);

/// How many rows ZIP or ZIPS puts together.
int rows_of_zip_chunk(const Imf::Header& header);

/// Whether read_zip_rows() reads these channels of such a part. All else is for OpenEXR.
bool is_zip_rows(const Imf::Header& header, std::span<const ExrRead> reads);

/// Reads `rows` rows of the part's data window, from the `first` one on, on as many of OpenEXR's threads as are
/// allowed, or on the caller's where that is none. Fails with a std::exception where chunks are missing or damaged.
void read_zip_rows(const Imf::InputPart& part, std::span<const ExrRead> reads, int first, int rows, int most_threads);

}  // namespace alcove
