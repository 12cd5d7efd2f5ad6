// libpng, wrapped: the only file that includes it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/png.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/formats/image_io.h"

namespace alcove {
namespace {

constexpr const char *kMadeBy = "alcove", *kShows = "Description";  // keywords of texts
constexpr std::size_t kTextWithin = 4096;                           // bytes that hold the texts, before the pixels

constexpr std::size_t kErrorBytes = 256;  // longer than any message of libpng

/// The target of libpng's callbacks: the encoded bytes, and the error. No exception may pass through libpng, and its
/// errors jump over destructors, so messages have a fixed place.
struct Sink {
  std::vector<char> bytes;
  std::array<char, kErrorBytes> error{};
  std::array<char, kErrorBytes> warning{};  // the last one, which often says why the error came
};

void copy_text(png_const_charp text, std::array<char, kErrorBytes>& to) {
  (void)std::snprintf(to.data(), to.size(), "%s", text);
}

/// Appends bytes; false if no memory is left.
bool has_appended(Sink& sink, const png_byte* bytes, std::size_t count) noexcept {
  try {
    sink.bytes.insert(sink.bytes.end(), bytes, bytes + count);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

void append(png_structp png, png_bytep bytes, png_size_t count) {
  // The jump begins here, since a jump in the error handler would never end.
  if (!has_appended(*static_cast<Sink*>(png_get_io_ptr(png)), bytes, count)) png_error(png, "no memory is left for it");
}

[[noreturn]] void keep_error(png_structp png, png_const_charp text) {
  copy_text(text, static_cast<Sink*>(png_get_error_ptr(png))->error);
  png_longjmp(png, 1);
}

void keep_warning(png_structp png, png_const_charp text) {
  copy_text(text, static_cast<Sink*>(png_get_error_ptr(png))->warning);
}

/// The reason that libpng gives for its failure.
std::string reason_of(const Sink& sink) {
  const std::string error = sink.error.data();
  return sink.warning[0] ? error + ": " + sink.warning.data() : error;
}

struct Writer {
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

/// Writes the picture. Nothing here has a destructor, since an error jumps from the calls below to the setjmp.
bool write_all(png_structp png, png_infop info, int width, int height, int channels, png_bytepp rows,
               std::span<png_text> texts) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), 8,
               channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!texts.empty()) png_set_text(png, info, texts.data(), int(texts.size()));
  png_write_info(png, info);
  png_write_image(png, rows);
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

std::vector<char> encode_png(const std::string& name, int width, int height, int channels,
                             std::span<const float> pixels, const std::string& made_by, const std::string& shows) {
  std::vector<png_byte> bytes(pixels.size());
  std::ranges::transform(pixels, bytes.begin(),
                         [](float x) { return png_byte(std::lround(255 * std::clamp(x, 0.0f, 1.0f))); });
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; y++)
    rows.push_back(bytes.data() + std::size_t(y) * std::size_t(width) * std::size_t(channels));

  // libpng takes texts by mutable pointers.
  std::array<std::pair<std::string, std::string>, 2> named_texts{{{kMadeBy, made_by}, {kShows, shows}}};
  std::vector<png_text> texts;
  for (auto& [keyword, value] : named_texts) {
    if (value.empty()) continue;
    png_text& text = texts.emplace_back();
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = keyword.data();
    text.text = value.data();
    text.text_length = value.size();
  }

  Sink sink;
  Writer writer;
  writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, keep_error, keep_warning);
  writer.info = writer.png ? png_create_info_struct(writer.png) : nullptr;
  if (!writer.info) fail(ErrorKind::output, "{}: could not be encoded as PNG: libpng does not start", name);
  png_set_write_fn(writer.png, &sink, append, nullptr);
  if (!write_all(writer.png, writer.info, width, height, channels, rows.data(), texts))
    fail(ErrorKind::output, "{}: could not be encoded as PNG: {}", name, reason_of(sink));
  return std::move(sink.bytes);
}

void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels,
               const std::string& made_by, const std::string& shows) {
  write_whole(path, encode_png(path, width, height, channels, pixels, made_by, shows));
}

// Reading.

namespace {

void take(png_structp png, png_bytep bytes, png_size_t count) {
  if (std::fread(bytes, 1, count, static_cast<std::FILE*>(png_get_io_ptr(png))) != count)
    png_error(png, "the file ends too early");
}

// Nothing in these three has a destructor, since an error jumps from the calls within to the setjmp.

/// Reads the header, and asks for one sample of 8 or 16 bits per channel, without a palette.
bool read_header(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_info(png, info);
  png_set_expand(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool read_row(png_structp png, png_bytep row) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_row(png, row, nullptr);
  return true;
}

bool read_all(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, rows);
  return true;
}

/// A picture as libpng has begun to read it.
struct Decoder {
  explicit Decoder(const std::string& path) {
    file = std::fopen(path.c_str(), "rb");
    png = file ? png_create_read_struct(PNG_LIBPNG_VER_STRING, &messages, keep_error, keep_warning) : nullptr;
    info = png ? png_create_info_struct(png) : nullptr;
    if (!info) return;
    png_set_read_fn(png, file, take);
    is_begun = read_header(png, info);
  }
  ~Decoder() {
    png_destroy_read_struct(&png, &info, nullptr);
    if (file) (void)std::fclose(file);
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  std::FILE* file = nullptr;
  Sink messages;
  png_structp png = nullptr;
  png_infop info = nullptr;
  bool is_begun = false;
  int next = 0;  // the row that comes next
};

// The most bytes of pixels for one byte of a file. Deflate packs 1032 bytes of up to 8 pixels each, of a palette with
// four channels.
constexpr std::uint64_t kDensest = 1032 * 8 * 4;

class PngReader : public PictureReader {
 public:
  PngReader(const std::string& path, const char* option) : path_(path), option_(option) {
    begin();
    data = display = {0, 0, int(png_get_image_width(decoder_->png, decoder_->info)),
                      int(png_get_image_height(decoder_->png, decoder_->info))};
    row_.resize(png_get_rowbytes(decoder_->png, decoder_->info));
    has_16_bits_ = png_get_bit_depth(decoder_->png, decoder_->info) == 16;
    const int channels = png_get_channels(decoder_->png, decoder_->info);
    names = channels < 3 ? std::vector<std::string>{"Y", "A"} : std::vector<std::string>{"R", "G", "B", "A"};
    names.resize(std::size_t(channels));
    if (const auto size = std::filesystem::file_size(path); row_.size() * std::uint64_t(data.height) / kDensest > size)
      fail(ErrorKind::input, "{}: its header claims {} pixels, which its {} bytes cannot hold ({})", path,
           to_string(data), size, option);
  }

  void read(int first, int rows, std::span<const Channel> channels) override {
    const bool is_interlaced = png_get_interlace_type(decoder_->png, decoder_->info) != PNG_INTERLACE_NONE;
    if (is_interlaced) read_interlaced();
    if (!is_interlaced && first < decoder_->next) begin();
    for (int row = is_interlaced ? first : decoder_->next; row < first + rows; row++) {
      const png_byte* bytes = row_.data();
      if (is_interlaced)
        bytes = whole_.data() + std::size_t(row) * row_.size();
      else
        require(read_row(decoder_->png, row_.data()));
      decoder_->next = row + 1;
      if (row >= first) give(bytes, std::size_t(row - first) * std::size_t(data.width), channels);
    }
  }

 private:
  void begin() {
    decoder_ = std::make_unique<Decoder>(path_);
    if (!decoder_->is_begun)
      fail(ErrorKind::input, "{}: not a picture that can be read ({}): {}", path_, option_,
           reason_of(decoder_->messages));
  }

  void require(bool is_read) const {
    if (!is_read)
      fail(ErrorKind::input, "{}: the pixels cannot be read, the file is damaged or incomplete ({}): {}", path_,
           option_, reason_of(decoder_->messages));
  }

  /// Interlaced rows come only together.
  void read_interlaced() {
    if (!whole_.empty()) return;
    whole_.resize(row_.size() * std::size_t(data.height));
    std::vector<png_bytep> rows;
    for (int y = 0; y < data.height; y++) rows.push_back(whole_.data() + std::size_t(y) * row_.size());
    require(read_all(decoder_->png, rows.data()));
  }

  void give(const png_byte* bytes, std::size_t to, std::span<const Channel> channels) const {
    const std::size_t size = has_16_bits_ ? 2 : 1;
    for (const Channel& channel : channels)
      for (std::size_t x = 0; x < std::size_t(data.width); x++) {
        const png_byte* sample = bytes + (x * names.size() + channel.index) * size;
        channel.to[to + x] =
            has_16_bits_ ? float(unsigned(sample[0]) << 8 | unsigned(sample[1])) / 65535 : float(sample[0]) / 255;
      }
  }

  const std::string path_, option_;
  std::unique_ptr<Decoder> decoder_;
  bool has_16_bits_ = false;
  std::vector<png_byte> row_, whole_;
};

}  // namespace

std::unique_ptr<PictureReader> open_png(const std::string& path, const char* option) {
  require_readable(path, "picture", option);
  return std::make_unique<PngReader>(path, option);
}

bool is_whole_png(const std::string& path, const std::string& made_by) {
  constexpr std::string_view kEnd("IEND\xae\x42\x60\x82");  // the last chunk, behind the four bytes of its length
  std::ifstream file(path, std::ios::binary);
  std::string begin(kTextWithin, '\0');
  std::string end(kEnd.size(), '\0');
  file.read(begin.data(), std::streamsize(begin.size()));
  file.clear();
  return begin.find(std::string(kMadeBy) + '\0' + made_by) != begin.npos &&
         file.seekg(-std::streamoff(end.size()), std::ios::end) && file.read(end.data(), std::streamsize(end.size())) &&
         end == kEnd;
}

}  // namespace alcove
