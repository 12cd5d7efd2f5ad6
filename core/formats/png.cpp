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
#include <fstream>
#include <memory>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/file.h"

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
