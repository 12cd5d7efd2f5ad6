// Deep parts: where chunks lie, threads that unpack them, and the surfaces of their pixels.
// SPDX-License-Identifier: BSD-3-Clause
//
// OpenEXR's document "File Layout" says how bytes are packed: split into halves, made differences, and deflated or put
// together as runs. OpenEXR's C core would do both, but 3.1.5 refuses what OpenEXR's C++ writes: deep parts beside flat
// ones, and tiles at the border without compression, whose counts are those of a whole tile.
#include "core/formats/exr_deep.h"

#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/base/error.h"
#include "core/base/half.h"
#include "core/base/image.h"
#include "core/base/system.h"
#include "core/formats/exr_shared.h"
#include "core/formats/sample_loops.h"

namespace alcove {

namespace {

constexpr std::uint64_t kDeflateRatio = 1032;  // of the longest match by the shortest code
constexpr std::uint64_t kRunRatio = 64;        // 128 bytes by two
constexpr std::uint64_t kShortest = 64;        // bytes that any chunk may have

bool inflate_all(std::span<const std::uint8_t> packed, std::span<std::uint8_t> to) {
  uLongf length = uLongf(to.size());
  return uncompress(to.data(), &length, packed.data(), uLong(packed.size())) == Z_OK && length == to.size();
}

/// Expands runs: a count below 0 stands before that many bytes; another count before a byte that comes once more often.
bool expand_runs(std::span<const std::uint8_t> packed, std::span<std::uint8_t> to) {
  std::size_t from = 0, at = 0;
  while (from < packed.size()) {
    const int count = std::int8_t(packed[from++]);
    const std::size_t length = count < 0 ? std::size_t(-count) : std::size_t(count) + 1;
    if (length > to.size() - at || (count < 0 ? length : 1) > packed.size() - from) return false;
    if (count < 0)
      std::copy_n(packed.begin() + std::ptrdiff_t(from), length, to.begin() + std::ptrdiff_t(at));
    else
      std::fill_n(to.begin() + std::ptrdiff_t(at), length, packed[from]);
    from += count < 0 ? length : 1;
    at += length;
  }
  return at == to.size();
}

/// Sums the differences up, and interleaves the bytes of both halves.
void put_together(std::span<std::uint8_t> split, std::span<std::uint8_t> to) {
  const std::size_t half = (split.size() + 1) / 2;
  sum_up(split.data() + 1, split.size() - 1, split[0]);
  interleave(split.data(), split.data() + half, split.size() / 2, to.data());
  if (split.size() % 2) to.back() = split[half - 1];
}

}  // namespace

std::uint64_t longest_unpacked(DeepCompression compression, std::uint64_t packed_bytes) {
  switch (compression) {
    case DeepCompression::none: return packed_bytes;
    case DeepCompression::rle: return kShortest + kRunRatio * packed_bytes;
    case DeepCompression::zip: break;
  }
  return kShortest + kDeflateRatio * packed_bytes;
}

bool unpack_deep(DeepCompression compression, std::span<const std::uint8_t> packed, std::span<std::uint8_t> to,
                 std::vector<std::uint8_t>& scratch) {
  // Bytes that packing would lengthen are stored as they are.
  if (packed.size() == to.size()) {
    std::ranges::copy(packed, to.begin());
    return true;
  }
  if (compression == DeepCompression::none || to.empty()) return false;
  if (scratch.size() < to.size()) scratch.resize(to.size());
  const std::span split(scratch.data(), to.size());
  if (!(compression == DeepCompression::zip ? inflate_all(packed, split) : expand_runs(packed, split))) return false;
  put_together(split, to);
  return true;
}

bool counts_of_table(std::span<const std::uint8_t> table, std::size_t width, std::vector<std::uint32_t>& counts) {
  counts.resize(table.size() / sizeof(std::uint32_t));
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < counts.size(); i++) {
    const auto until = number_at<std::uint32_t>(table.data() + i * sizeof(std::uint32_t));
    if (i % width == 0) sum = 0;
    if (until < sum || until > std::uint32_t(std::numeric_limits<std::int32_t>::max())) return false;
    counts[i] = until - sum;
    sum = until;
  }
  return true;
}

bool lines_of_counts(std::span<const std::uint32_t> counts, std::size_t width, std::uint64_t sample_bytes,
                     std::uint64_t bytes, std::vector<std::size_t>& lines) {
  // The samples left are counted down: a sum of sizes that a file has chosen could wrap.
  std::uint64_t left = bytes / sample_bytes;
  lines.clear();
  for (std::size_t i = 0; i < counts.size(); i++) {
    if (i % width == 0) lines.push_back(bytes - left * sample_bytes);
    if (counts[i] > left) return false;
    left -= counts[i];
  }
  lines.push_back(bytes);
  return left == 0 && bytes % sample_bytes == 0;
}

namespace {

constexpr std::uint64_t kMostChunk = std::uint64_t(1) << 28;  // bytes: more than any line or tile that was ever seen
constexpr std::uint64_t kCopies = 3;                          // of a chunk: packed, split in halves, unpacked

/// The meaning of a deep channel.
enum class Role { none, front, back, alpha };

/// A channel that is read, and its place: chunks hold each line channel by channel.
struct WantedChannel {
  Role role;
  Imf::PixelType type;
  std::size_t offset;  // bytes of a sample's channels before it
};

/// The place of a chunk's table of counts, and the sizes of that table and of its samples, which follow it; in bytes.
struct Chunk {
  std::uint64_t table = 0, table_size = 0, packed_size = 0, unpacked_size = 0;
};

/// A part of the file, its chunks, and the channels that are read.
struct Part : DeepStored {
  explicit Part(const DeepStored& stored) : DeepStored(stored) {}

  Window data = window_of(header.dataWindow());
  bool is_tiled = header.type() == Imf::DEEPTILE;
  int tile_width = data.width, tile_height = 1;  // px; for scan lines: a chunk
  DeepCompression compression = header.compression() == Imf::NO_COMPRESSION    ? DeepCompression::none
                                : header.compression() == Imf::RLE_COMPRESSION ? DeepCompression::rle
                                                                               : DeepCompression::zip;
  std::uint64_t file_bytes = 0;
  std::vector<Chunk> chunks;         // row by row
  std::vector<WantedChannel> taken;  // channels to read
  std::size_t sample_bytes = 0;      // of all channels
  // Bytes of the counts of a whole tile, which tiles at the border may store too; 0: more than any chunk may hold.
  std::uint64_t whole_table = 0;
  bool has_back = false;
  std::size_t alphas = 0;  // 1, or 3 of red, green and blue, whose mean counts; 0: every sample is opaque

  std::int64_t across() const { return (std::int64_t(data.width) + tile_width - 1) / tile_width; }
  std::int64_t down() const { return (std::int64_t(data.height) + tile_height - 1) / tile_height; }
  std::size_t chunk_width(int column) const {
    return std::size_t(std::min(tile_width, data.width - column * tile_width));
  }
  std::size_t chunk_height(int row) const {
    return std::size_t(std::min(tile_height, data.height - row * tile_height));
  }
};

float value_at(const std::uint8_t* at, Imf::PixelType type) {
  if (type == Imf::HALF) return from_half(number_at<std::uint16_t>(at));
  return type == Imf::FLOAT ? number_at<float>(at) : float(number_at<std::uint32_t>(at));
}

bool read_at(std::ifstream& file, std::uint64_t offset, std::span<std::uint8_t> to) {
  file.clear();
  return file.seekg(std::streamoff(offset)) &&
         file.read(reinterpret_cast<char*>(to.data()), std::streamsize(to.size()));
}

/// A thread's chunk, packed and unpacked.
struct Unpacked {
  std::vector<std::uint8_t> packed, table, data, scratch;
  std::vector<std::uint32_t> counts;  // of each pixel
  std::vector<std::size_t> lines;     // place of each line's samples, bytes
  std::vector<DeepSample> samples;    // of one line
  std::size_t next = 0;               // the next of these samples
};

/// The unpacked chunks of a part that cover a line of a cell.
struct Loaded {
  std::ifstream file;
  std::vector<Unpacked> chunks;  // side by side
  int row = -1, first = -1;      // their row and first column in the part; -1: none yet
  Window shown;                  // the line's pixels within the part
};

}  // namespace

struct DeepReader::Impl {
  const char* option;
  Window data;
  DeepRules rules;
  std::vector<Part> parts;
  // The pixels that a thread makes at once: a chunk if all parts have the same, else as many lines as the largest chunk
  // has.
  Window cell;
  std::size_t workers = 1;
  std::uint64_t worker_bytes = 0;  // memory of a thread for the largest chunks of all parts
  DeepCounts counts;
  std::vector<bool> counted;  // one per line: read before

  Impl(const char* option_, const Window& data_, const DeepRules& rules_)
      : option(option_), data(data_), rules(rules_) {}

  [[noreturn]] void refuse(const Part& part, const std::string& why) const {
    fail(ErrorKind::input, "{}: the deep samples of part {} cannot be read ({}), the file is damaged or incomplete: {}",
         part.path, part.part, option, why);
  }
  int across() const { return int((std::int64_t(data.width) + cell.width - 1) / cell.width); }

  void add_part(const DeepStored& stored);
  void find_channels(Part& part) const;
  void find_chunks(Part& part) const;
  Chunk chunk_at(const Part& part, std::ifstream& file, std::uint64_t offset, int column, int row) const;
  void choose_cell();
  void share_out(std::uint64_t most_bytes);
  void unpack(const Part& part, int column, int row, std::ifstream& file, Unpacked& to) const;
  void load(const Part& part, const Window& line, Loaded& to) const;
  void take_line(const Part& part, std::size_t line, Unpacked& chunk) const;
};

void DeepReader::Impl::add_part(const DeepStored& stored) {
  Part part(stored);
  if (part.is_tiled) {
    constexpr unsigned kMost = std::numeric_limits<int>::max();
    part.tile_width = int(std::min(part.header.tileDescription().xSize, kMost));
    part.tile_height = int(std::min(part.header.tileDescription().ySize, kMost));
  }
  if (part.tile_width <= 0 || part.tile_height <= 0) refuse(part, "its tiles are empty");
  const std::uint64_t pixels = std::uint64_t(part.tile_width) * std::uint64_t(part.tile_height);
  part.whole_table = pixels < kMostChunk / sizeof(std::uint32_t) ? sizeof(std::uint32_t) * pixels : 0;
  // Larger tiles would hold no more pixels.
  part.tile_width = std::min(part.tile_width, part.data.width);
  part.tile_height = std::min(part.tile_height, part.data.height);
  find_channels(part);
  std::error_code error;
  part.file_bytes = std::filesystem::file_size(part.path, error);
  if (error) part.file_bytes = 0;
  find_chunks(part);
  parts.push_back(std::move(part));
}

void DeepReader::Impl::find_channels(Part& part) const {
  const Imf::ChannelList& channels = part.header.channels();
  const auto has = [&](const char* name) { return channels.findChannel(name) != nullptr; };
  const auto role_of = [&](const std::string& name) {
    if (name == "Z") return Role::front;
    if (name == "ZBack") return Role::back;
    const bool is_alpha = has("A") ? name == "A" : name == "AR" || name == "AG" || name == "AB";
    return is_alpha ? Role::alpha : Role::none;
  };
  for (auto at = channels.begin(); at != channels.end(); ++at) {
    const Role role = role_of(at.name());
    if (role != Role::none) part.taken.push_back({role, at.channel().type, part.sample_bytes});
    part.has_back |= role == Role::back;
    part.alphas += role == Role::alpha;
    part.sample_bytes += bytes_of(at.channel().type);
  }
  if (!has("Z"))
    fail(ErrorKind::input,
         "{}: the base layer of deep part {} has no Z, so its samples lie nowhere; write it with Z, or name another "
         "part with --layer ({})",
         part.path, part.part, option);
}

/// Reads the places of the chunks, at most as many as the file has room for.
void DeepReader::Impl::find_chunks(Part& part) const {
  constexpr std::uint64_t kOffset = 8;  // bytes
  const std::uint64_t count = std::uint64_t(part.across()) * std::uint64_t(part.down());
  if (part.offsets > part.file_bytes || count > (part.file_bytes - part.offsets) / kOffset)
    refuse(part, "it has more chunks than the file has room for");
  std::ifstream file(part.path, std::ios::binary);
  std::vector<std::uint8_t> offsets(kOffset * count);
  if (!read_at(file, part.offsets, offsets)) refuse(part, "it ends in the table of its chunks");
  part.chunks.reserve(count);
  for (int row = 0; row < part.down(); row++)
    for (int column = 0; column < part.across(); column++)
      part.chunks.push_back(
          chunk_at(part, file, number_at<std::uint64_t>(offsets.data() + kOffset * part.chunks.size()), column, row));
}

/// Reads the place and the sizes of a chunk, and refuses sizes that the file or the compression cannot hold.
Chunk DeepReader::Impl::chunk_at(const Part& part, std::ifstream& file, std::uint64_t offset, int column,
                                 int row) const {
  std::array<std::uint8_t, 44> head{};  // the longest: part, place of a tile, three sizes
  const std::size_t place = part.names_part ? 4 : 0, sizes = place + (part.is_tiled ? 16 : 4), length = sizes + 24;
  const auto is_within = [&](std::uint64_t from, std::uint64_t size) {
    return size <= part.file_bytes && from <= part.file_bytes - size;
  };
  if (offset == 0 || !is_within(offset, length) || !read_at(file, offset, std::span(head).first(length)))
    refuse(part, fmt::format("chunk {}, {} is missing", column, row));
  const auto holds = [&](std::size_t at, std::int64_t number) {
    return std::int64_t(number_at<std::int32_t>(head.data() + at)) == number;
  };
  const bool is_right =
      (!part.names_part || holds(0, part.part)) &&
      (part.is_tiled ? holds(place, column) && holds(place + 4, row) && holds(place + 8, 0) && holds(place + 12, 0)
                     : holds(place, std::int64_t(part.data.y) + std::int64_t(row) * part.tile_height));
  if (!is_right) refuse(part, fmt::format("at the place of chunk {}, {} is something else", column, row));

  const Chunk chunk{offset + length, number_at<std::uint64_t>(head.data() + sizes),
                    number_at<std::uint64_t>(head.data() + sizes + 8),
                    number_at<std::uint64_t>(head.data() + sizes + 16)};
  const std::uint64_t table = sizeof(std::uint32_t) * part.chunk_width(column) * part.chunk_height(row);
  if (!is_within(chunk.table, chunk.table_size) || !is_within(chunk.table + chunk.table_size, chunk.packed_size) ||
      chunk.table_size > std::max(table, part.whole_table) || chunk.packed_size > chunk.unpacked_size ||
      table > longest_unpacked(part.compression, chunk.table_size) ||
      chunk.unpacked_size > longest_unpacked(part.compression, chunk.packed_size))
    refuse(part, fmt::format("chunk {}, {} claims more than the file can hold", column, row));
  if (chunk.unpacked_size + table > kMostChunk)
    refuse(part, fmt::format("chunk {}, {} holds more than {} MiB", column, row, kMostChunk >> 20));
  return chunk;
}

/// The memory for making surfaces, per sample of a line, if all samples are of one pixel: growing vectors are up to
/// twice as long as their contents.
static std::uint64_t bytes_of_sample(const Part& part, bool is_alone) {
  constexpr std::uint64_t kSurface = 2 * sizeof(float), kGrowth = 2;
  const std::uint64_t together = is_alone ? 0 : kGrowth * sizeof(DeepSample);
  const std::uint64_t volumes = part.has_back ? (kGrowth + 1) * sizeof(DeepSample) : 0;
  return sizeof(DeepSample) + together + volumes + kGrowth * kSurface;
}

void DeepReader::Impl::choose_cell() {
  const Part& first = parts.front();
  const bool are_alike = std::ranges::all_of(parts, [&](const Part& part) {
    return part.data == data && part.tile_width == first.tile_width && part.tile_height == first.tile_height;
  });
  const int lines = std::ranges::max(parts, {}, &Part::tile_height).tile_height;
  cell = are_alike ? Window{0, 0, first.tile_width, first.tile_height}
                   : Window{0, 0, data.width, std::min(lines, data.height)};
}

/// Chooses the number of threads that may work on the largest chunks.
void DeepReader::Impl::share_out(std::uint64_t most_bytes) {
  for (const Part& part : parts) {
    std::uint64_t largest = 0, samples = 0;
    for (const Chunk& chunk : part.chunks) {
      const bool may_be_whole = part.whole_table <= longest_unpacked(part.compression, chunk.table_size);
      largest = std::max({largest, chunk.unpacked_size, may_be_whole ? part.whole_table : 0});
      samples = std::max(samples, chunk.unpacked_size / part.sample_bytes);
    }
    const std::uint64_t tables =
        2 * sizeof(std::uint32_t) * std::uint64_t(part.tile_width) * std::uint64_t(part.tile_height);
    const auto together = std::uint64_t(cell.width == part.tile_width ? 1 : part.across());
    worker_bytes += together * (kCopies * (largest + tables) + samples * bytes_of_sample(part, parts.size() == 1));
  }
  if (worker_bytes > most_bytes)
    fail(ErrorKind::input,
         "{}: its largest deep lines or tiles take {} MiB to read, and only {} MiB are allowed: raise --memory, or "
         "write smaller ones ({})",
         parts.front().path, worker_bytes / kMebibyte + 1, most_bytes / kMebibyte, option);
  workers = exr_workers(most_bytes / std::max<std::uint64_t>(1, worker_bytes), std::numeric_limits<std::size_t>::max());
}

void DeepReader::Impl::unpack(const Part& part, int column, int row, std::ifstream& file, Unpacked& to) const {
  const Chunk& chunk = part.chunks[std::size_t(row) * std::size_t(part.across()) + std::size_t(column)];
  const std::size_t width = part.chunk_width(column),
                    table_bytes = sizeof(std::uint32_t) * width * part.chunk_height(row);
  to.table.resize(chunk.table_size);
  to.packed.resize(chunk.packed_size);
  if (!file.is_open()) file.open(part.path, std::ios::binary);
  if (!read_at(file, chunk.table, to.table) || !read_at(file, chunk.table + chunk.table_size, to.packed))
    refuse(part, fmt::format("chunk {}, {} is not whole", column, row));
  const bool may_be_whole = part.whole_table <= longest_unpacked(part.compression, chunk.table_size);
  const std::size_t whole_bytes = may_be_whole ? part.whole_table : 0;
  to.data.resize(std::max({table_bytes, whole_bytes, std::size_t(chunk.unpacked_size)}));
  const auto table = std::span(to.data).first(table_bytes), data = std::span(to.data).first(chunk.unpacked_size);
  const auto whole = std::span(to.data).first(whole_bytes);
  const bool is_table = (whole.size() > table.size() && unpack_deep(part.compression, to.table, whole, to.scratch)) ||
                        unpack_deep(part.compression, to.table, table, to.scratch);
  if (!is_table || !counts_of_table(table, width, to.counts))
    refuse(part, fmt::format("the counts of chunk {}, {} are damaged", column, row));
  if (!lines_of_counts(to.counts, width, part.sample_bytes, chunk.unpacked_size, to.lines))
    refuse(part, fmt::format("the counts of chunk {}, {} are not those of its samples", column, row));
  if (!unpack_deep(part.compression, to.packed, data, to.scratch))
    refuse(part, fmt::format("the samples of chunk {}, {} are damaged", column, row));
}

/// Decodes the samples of a chunk's line.
void DeepReader::Impl::take_line(const Part& part, std::size_t line, Unpacked& chunk) const {
  const std::size_t count = (chunk.lines[line + 1] - chunk.lines[line]) / part.sample_bytes;
  chunk.samples.assign(count, {0, 0, part.alphas == 0 ? 1.0F : 0.0F});
  chunk.next = 0;
  for (const auto& channel : part.taken) {
    const std::uint8_t* at = chunk.data.data() + chunk.lines[line] + channel.offset * count;
    const auto each = [&](auto&& take) {
      for (auto& sample : chunk.samples) {
        take(sample, value_at(at, channel.type));
        at += bytes_of(channel.type);
      }
    };
    const float part_of_alpha = 1.0F / float(std::max<std::size_t>(1, part.alphas));
    if (channel.role == Role::front) each([](DeepSample& sample, float z) { sample.front = z; });
    if (channel.role == Role::back) each([](DeepSample& sample, float z) { sample.back = z; });
    if (channel.role == Role::alpha) each([&](DeepSample& sample, float a) { sample.opacity += a * part_of_alpha; });
  }
  if (!part.has_back)
    for (auto& sample : chunk.samples) sample.back = sample.front;
}

/// Unpacks the chunks that cover a line of a cell, unless they are loaded, and decodes the line's samples.
void DeepReader::Impl::load(const Part& part, const Window& line, Loaded& to) const {
  to.shown = common_part(part.data, line);
  if (to.shown.pixels() == 0) return;
  const int row = (line.y - part.data.y) / part.tile_height, first = (to.shown.x - part.data.x) / part.tile_width;
  const int last = (to.shown.x + to.shown.width - 1 - part.data.x) / part.tile_width;
  const auto count = std::size_t(last - first + 1);
  if (to.row != row || to.first != first || to.chunks.size() != count) {
    to.chunks.resize(count);
    for (int column = first; column <= last; column++)
      unpack(part, column, row, to.file, to.chunks[std::size_t(column - first)]);
    to.row = row;
    to.first = first;
  }
  for (auto& chunk : to.chunks) take_line(part, std::size_t(line.y - part.data.y - row * part.tile_height), chunk);
}

/// The samples of the next pixel of a part's line; none outside of the part.
static std::span<DeepSample> next_pixel(const Part& part, Loaded& loaded, int x, int y) {
  if (x < loaded.shown.x || x >= loaded.shown.x + loaded.shown.width) return {};
  const int across = x - part.data.x, column = across / part.tile_width;
  const std::size_t width = part.chunk_width(column);
  Unpacked& chunk = loaded.chunks[std::size_t(column - loaded.first)];
  const std::size_t line = std::size_t(y - part.data.y) % std::size_t(part.tile_height);
  const std::size_t pixel = line * width + std::size_t(across - column * part.tile_width);
  const std::span samples = std::span(chunk.samples).subspan(chunk.next, chunk.counts[pixel]);
  chunk.next += samples.size();
  return samples;
}

/// The samples of the next pixel of a line in all parts together.
static std::span<DeepSample> next_pixel(const std::vector<Part>& parts, std::vector<Loaded>& loaded, int x, int y,
                                        std::vector<DeepSample>& together) {
  if (parts.size() == 1) return next_pixel(parts[0], loaded[0], x, y);
  together.clear();
  for (std::size_t i = 0; i < parts.size(); i++)
    std::ranges::copy(next_pixel(parts[i], loaded[i], x, y), std::back_inserter(together));
  return together;
}

DeepReader::DeepReader(const char* option, const Window& data, const std::vector<DeepStored>& parts,
                       const DeepRules& rules, std::uint64_t most_bytes)
    : impl_(std::make_unique<Impl>(option, data, rules)) {
  for (const auto& part : parts) impl_->add_part(part);
  impl_->choose_cell();
  impl_->share_out(most_bytes);
}

DeepReader::~DeepReader() = default;
const DeepCounts& DeepReader::counts() const { return impl_->counts; }
std::uint64_t DeepReader::bytes() const { return impl_->worker_bytes * impl_->workers; }

void DeepReader::read(std::span<const DeepRead> reads, int first, int rows) {
  if (rows <= 0) return;
  const auto& parts = impl_->parts;
  const Window &data = impl_->data, &cell_size = impl_->cell;
  const int top = first / cell_size.height, bottom = (first + rows - 1) / cell_size.height + 1;
  const std::size_t across = std::size_t(impl_->across()), cells = across * std::size_t(bottom - top);
  const std::size_t workers = std::min(impl_->workers, cells);
  std::vector<std::vector<Loaded>> loaded(workers);
  for (auto& mine : loaded) mine = std::vector<Loaded>(parts.size());
  std::vector<DeepCounts> counts(workers);
  impl_->counted.resize(std::size_t(data.height));

  const auto read_cell = [&](std::size_t cell, std::size_t worker) {
    const int left = int(cell % across) * cell_size.width, upper = (top + int(cell / across)) * cell_size.height;
    auto& mine = loaded[worker];
    const int width = std::min(cell_size.width, data.width - left);
    DeepPixel deep(impl_->rules);
    std::vector<DeepSample> together;
    for (int y = std::max(first, upper); y < std::min({upper + cell_size.height, first + rows, data.height}); y++) {
      const Window line{data.x + left, data.y + y, width, 1};
      for (std::size_t i = 0; i < parts.size(); i++) impl_->load(parts[i], line, mine[i]);
      DeepCounts again;
      DeepCounts& of_line = impl_->counted[std::size_t(y)] ? again : counts[worker];
      const std::size_t at = std::size_t(y - first) * std::size_t(data.width) + std::size_t(left);
      for (int x = 0; x < width; x++) {
        const auto samples = next_pixel(parts, mine, line.x + x, line.y, together);
        const DeepSurfaces surfaces = deep.surfaces(samples, of_line);
        for (const auto& read : reads)
          read.to[at + std::size_t(x)] = (read.back ? surfaces.back : surfaces.front)[read.surface];
      }
    }
  };
  on_exr_threads(cells, workers, read_cell);
  for (const auto& part : counts) impl_->counts.add(part);
  std::fill_n(impl_->counted.begin() + first, rows, true);
}

}  // namespace alcove
