// The table of signatures, and the reader for each format. That of OpenImageIO is loaded on first use.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/formats/exr.h"
#include "core/formats/image_io.h"

namespace alcove {
namespace {

using namespace std::string_view_literals;

enum class Reader {
  exr,
  dds,
  png,
  npy,
  picture,  // OpenImageIO, for frames too
  other,    // OpenImageIO, for no frame
};

/// Bytes that a file of a format has at a fixed place.
struct Signature {
  const char* format;
  Reader reader;
  std::string_view bytes;
  std::size_t offset = 0;
};

// Each format's own specification gives its signature. Formats that no frame may have are listed so that a message can
// name them.
constexpr Signature kSignatures[] = {
    {"an OpenEXR", Reader::exr, "\x76\x2f\x31\x01"sv},
    {"a DDS", Reader::dds, "DDS "sv},
    {"a PNG", Reader::png, "\x89PNG\r\n\x1a\n"sv},
    {"a NumPy", Reader::npy, "\x93NUMPY"sv},
    {"a ZIP (as .npz is)", Reader::other, "PK\3\4"sv},
    {"a TIFF", Reader::picture, "II*\0"sv},
    {"a TIFF", Reader::picture, "MM\0*"sv},
    {"a BigTIFF", Reader::picture, "II+\0"sv},
    {"a BigTIFF", Reader::picture, "MM\0+"sv},
    {"a BMP", Reader::picture, "BM"sv},
    {"a Radiance HDR", Reader::picture, "#?"sv},
    {"a JPEG", Reader::other, "\xff\xd8\xff"sv},
    {"a JPEG 2000", Reader::other, "\0\0\0\x0cjP  "sv},
    {"a GIF", Reader::other, "GIF8"sv},
    {"a Photoshop", Reader::other, "8BPS"sv},
    {"a WebP", Reader::other, "WEBP"sv, 8},
    {"a DPX", Reader::other, "SDPX"sv},
    {"a DPX", Reader::other, "XPDS"sv},
    {"an HEIF or MP4", Reader::other, "ftyp"sv, 4},
};
constexpr std::size_t kHeadBytes = 12;  // every signature lies within them

// TGA has no signature at its beginning. Files of its second version have this one at their end.
constexpr std::string_view kTgaEnd = "TRUEVISION-XFILE.\0"sv;
constexpr Signature kTga{"a TGA", Reader::picture, ""sv};

std::string read_some(std::ifstream& file, std::size_t bytes) {
  std::string text(bytes, '\0');
  file.read(text.data(), std::streamsize(bytes));
  text.resize(std::size_t(file.gcount()));
  return text;
}

bool has_tga_end(std::ifstream& file) {
  file.clear();
  return file.seekg(-std::streamoff(kTgaEnd.size()), std::ios::end) && read_some(file, kTgaEnd.size()) == kTgaEnd;
}

/// Gives the format of a file, or null if it is unknown.
const Signature* format_of(const std::string& path, std::ifstream& file, const std::string& head) {
  const auto* found = std::ranges::find_if(kSignatures, [&](const Signature& signature) {
    return std::string_view(head).substr(std::min(signature.offset, head.size())).starts_with(signature.bytes);
  });
  if (found != std::end(kSignatures)) return found;
  return has_tga_end(file) || lower_case(path).ends_with(".tga") ? &kTga : nullptr;
}

/// Loads the module; if that fails, gives null, with the reason in `why`. The program's run path finds it beside the
/// program or in ../lib/alcove.
const ImageIoModule* load(std::string& why) {
  return static_cast<const ImageIoModule*>(symbol_of(kImageIoFile, kImageIoSymbol, why));
}

/// The loaded module. Fails for `path`, the picture that needs it.
const ImageIoModule& module(const std::string& path) {
  static const ImageIoModule* loaded = [&] {
    std::string why;
    const ImageIoModule* found = load(why);
    if (!found)
      fail(ErrorKind::input,
           "{}: to read a picture that is no EXR, DDS, PNG or NumPy array, Alcove needs {}, of the package "
           "alcove-pictures, which is built where OpenImageIO is installed (libopenimageio-dev): {}",
           path, kImageIoFile, why);
    return found;
  }();
  return *loaded;
}

[[noreturn]] void refuse(const std::string& path, const char* option, const std::string& what) {
  fail(ErrorKind::input, "{}: {}; {} takes an {} file", path, what, option, frame_formats());
}

}  // namespace

const char* frame_formats() { return "OpenEXR, DDS, PNG, NumPy, TIFF, TGA, BMP or Radiance HDR"; }

std::string why_no_image_io() {
  std::string why;
  return load(why) ? "" : why;
}

std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option) {
  return module(path).open_picture(path, option);
}

ExrFile open_image(const std::string& path, const char* option, Formats formats) {
  require_readable(path, "picture", option);
  if (!std::filesystem::is_regular_file(path)) refuse(path, option, "is no regular file");
  std::ifstream file(path, std::ios::binary);
  const std::string head = read_some(file, kHeadBytes);
  const Signature* format = format_of(path, file, head);
  if (formats == Formats::of_frames && head.empty()) refuse(path, option, "is empty");
  if (formats == Formats::of_frames && !format) refuse(path, option, "is not a picture of a known format");
  if (formats == Formats::of_frames && format->reader == Reader::other)
    refuse(path, option, fmt::format("is {} file", format->format));
  if (format && format->reader == Reader::exr) return ExrFile(path, option);
  if (format && format->reader == Reader::dds) return {path, option, open_dds(path, option)};
  if (format && format->reader == Reader::png) return {path, option, open_png(path, option)};
  if (format && format->reader == Reader::npy) return {path, option, open_npy(path, option)};
  return {path, option, open_picture(path, option)};
}

}  // namespace alcove
