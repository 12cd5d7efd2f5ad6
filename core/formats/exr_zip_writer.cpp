// Rows go into chunks, some of which are packed at once and then written in their order.
// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "core/formats/exr_shared.h"
#include "core/formats/exr_zip.h"
#include "core/formats/sample_loops.h"

namespace alcove {
namespace {

/// As OpenEXR has it for its own, so that no thread waits for the slowest.
constexpr std::size_t kChunksOfThread = 2;

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// A type that the input's header brought along is that of another file.
Imf::Header of_lines(Imf::Header header) {
  if (header.hasType()) header.setType(Imf::SCANLINEIMAGE);
  return header;
}

void write_word(Imf::OStream& stream, std::int32_t word) {
  stream.write(reinterpret_cast<const char*>(&word), sizeof(word));
}

}  // namespace

ZipWriter::ZipWriter(Imf::OStream& stream, const Imf::Header& header) : stream_(stream), header_(of_lines(header)) {
  header_.sanityCheck();
  const Window data = window_of(header_.dataWindow());
  width_ = std::size_t(data.width);
  height_ = std::size_t(data.height);
  chunk_rows_ = std::size_t(rows_of_zip_chunk(header_));
  row_bytes_ = zip_row_bytes(header_);
  if (!is_zip_rows(header_)) throw std::logic_error("this part is for OpenEXR");
  const std::size_t workers = exr_workers(kAll, kAll);
  chunks_ = std::vector<Chunk>(workers > 1 ? kChunksOfThread * workers : 1);
  Imf::StdOSStream head;  // one write instead of hundreds
  writeMagicNumberAndVersionField(head, header_);
  header_.writeTo(head);
  const std::string bytes = head.str();
  stream_.write(bytes.data(), int(bytes.size()));
  table_ = stream_.tellp();
  const std::vector<std::uint64_t> nowhere((height_ + chunk_rows_ - 1) / chunk_rows_);
  stream_.write(reinterpret_cast<const char*>(nowhere.data()), int(nowhere.size() * sizeof(std::uint64_t)));
}

std::size_t ZipWriter::rows_of(std::size_t chunk) const {
  return std::min(chunk_rows_, height_ - std::min(height_, chunk * chunk_rows_));
}

void ZipWriter::write(std::span<const Source> sources, std::size_t rows) {
  if (rows > height_ - std::min(height_, offsets_.size() * chunk_rows_) - chunks_[0].rows)
    throw std::logic_error("there are more rows than pixels");
  for (std::size_t row = 0; row < rows;) {
    std::size_t count = 0;  // chunks that are full
    std::vector<std::size_t> firsts, taken;
    for (; count < chunks_.size() && row < rows; count++) {
      const std::size_t has = chunks_[count].rows, wants = rows_of(offsets_.size() + count) - has;
      firsts.push_back(row);
      taken.push_back(std::min(wants, rows - row));
      row += taken.back();
      if (taken.back() < wants) break;
    }
    on_exr_threads(taken.size(), exr_workers(taken.size(), kAll), [&](std::size_t i, std::size_t) {
      add_rows(chunks_[i], sources, firsts[i], taken[i]);
      if (i < count) chunks_[i].stored = chunks_[i].packer.pack(chunks_[i].bytes);
    });
    write_chunks(std::span(chunks_).first(count));
    // What is not full yet is the first of the next.
    if (count > 0 && count < chunks_.size()) std::swap(chunks_[0], chunks_[count]);
  }
}

void ZipWriter::add_rows(Chunk& chunk, std::span<const Source> sources, std::size_t first, std::size_t rows) const {
  chunk.bytes.resize((chunk.rows + rows) * row_bytes_);
  std::uint8_t* to = chunk.bytes.data() + chunk.rows * row_bytes_;
  for (std::size_t row = first; row < first + rows; row++) {
    auto source = sources.begin();
    for (auto at = header_.channels().begin(); at != header_.channels().end(); ++at, ++source) {
      const bool is_half = at.channel().type == Imf::HALF, narrows = is_half && source->is_float;
      const std::size_t bytes = width_ * bytes_of(at.channel().type);
      const auto* from = static_cast<const std::byte*>(source->samples) + row * (narrows ? 2 : 1) * bytes;
      if (narrows)
        narrow(reinterpret_cast<const float*>(from), width_, reinterpret_cast<std::uint16_t*>(to));
      else
        std::memcpy(to, from, bytes);
      to += bytes;
    }
  }
  chunk.rows += rows;
}

void ZipWriter::write_chunks(std::span<Chunk> chunks) {
  for (auto& chunk : chunks) {
    const int top = header_.dataWindow().min.y + int(offsets_.size() * chunk_rows_);
    offsets_.push_back(stream_.tellp());
    write_word(stream_, top);
    write_word(stream_, std::int32_t(chunk.stored.size()));
    stream_.write(reinterpret_cast<const char*>(chunk.stored.data()), int(chunk.stored.size()));
    chunk.rows = 0;
  }
}

void ZipWriter::finish() {
  if (offsets_.size() * chunk_rows_ < height_) throw std::logic_error("there are fewer rows than pixels");
  stream_.seekp(table_);
  stream_.write(reinterpret_cast<const char*>(offsets_.data()), int(offsets_.size() * sizeof(std::uint64_t)));
}

}  // namespace alcove
