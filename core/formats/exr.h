// Reads, writes and copies OpenEXR files: headers, chosen channels in one pass, whole files. Pictures of other formats
// are read by the same class.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/formats/deep_surfaces.h"

namespace alcove {

enum class SampleType { half_float, single_float, integer };

struct ExrChannel {
  std::string name;
  SampleType type;
  bool subsampled;  // fewer samples than pixels: cannot be read as a plane
};

/// The storage of a deep part, in the words of OpenEXR.
struct DeepLayout {
  std::string state;  // of its samples: messy (also if not given), sorted, non-overlapping or tidy
  std::string compression;
  bool is_tiled = false;
};

struct ExrPart {
  std::string name;  // empty in single-part files
  std::string view;  // of stereo files that have one part per view; empty: none
  // for stereo files whose channels name their view: the views, the default first; empty: none
  std::vector<std::string> multi_view;
  Window data;
  std::vector<ExrChannel> channels;
  int rows_together = 1;  // rows compressed together: multiples of them are decoded without waste
  // for a part with several samples per pixel, or none; its channels are not planes: see ExrFile::take_deep()
  std::optional<DeepLayout> deep = {};
  bool dwa = false;  // compressed by DWAA or DWAB, which are lossy for channels whose name ends in R, G, B, Y, RY or BY
};

/// The attributes of one part's header, of every type, with the attributes that only the first part has. Outputs get
/// them.
class ExrAttributes;
class PictureReader;

/// A channel to read, and its destination: one float per pixel, row by row, for the part's data window or for some of
/// its rows.
struct ExrRead {
  int part;
  std::string channel;
  float* to;
};

class ExrFile;

/// Deep parts of another file, whose samples count together with those of the first.
struct DeepElement {
  const ExrFile* file;
  std::vector<int> parts;
};

/// An EXR file whose header has been read. Every failure is ErrorKind::input and names the file.
class ExrFile {
 public:
  /// Opens a file and reads its header. Fails on a missing file, a folder, a file that is not an EXR, a part without
  /// channels, and headers that ask for more than their file can hold.
  explicit ExrFile(const std::string& path, const char* option);
  /// Wraps a picture of another format, which is then read like an EXR of one part.
  ExrFile(const std::string& path, const char* option, std::unique_ptr<PictureReader> picture);
  ~ExrFile();
  ExrFile(ExrFile&&) noexcept;

  const std::string& path() const;
  const std::vector<ExrPart>& parts() const;
  const Window& display() const;
  /// The width of a pixel over its height.
  double pixel_aspect() const;
  std::shared_ptr<const ExrAttributes> attributes(int part) const;
  /// Gives the attributes of a part that do not describe its storage, as text. Numbers, strings and matrices are given
  /// by value, cut off at 64 KiB, and all others by type.
  std::map<std::string, std::string> attribute_texts(int part) const;
  /// Gives the whole text of every text attribute whose name begins with `prefix`.
  std::map<std::string, std::string> whole_texts(int part, const std::string& prefix) const;

  /// The most bytes that codecs work on while the file is read.
  std::uint64_t bytes_beside_pixels() const;
  /// The bytes of the rows that are decoded together; 0 for other formats.
  std::uint64_t codec_group() const;
  /// Frees the memory of reading. Afterwards only parts, windows and bytes_beside_pixels() are available.
  void close();

  /// Makes surfaces from the deep samples of these parts and of `others`, all together. Then they are the channels
  /// deep_channel() of the first part, over the pixels of `data`, which becomes this part's data window. A part may
  /// lack some of these pixels. Fails if a part has no Z, and if chunks claim more than their file can hold.
  void take_deep(const std::vector<int>& parts, const DeepRules& rules, const Window& data,
                 std::span<const DeepElement> others = {});
  /// Makes surfaces of deep samples over the window of the first part.
  void take_deep(const std::vector<int>& parts, const DeepRules& rules);
  /// The counts over the deep samples that were read so far.
  DeepCounts deep_counts() const;

  /// Reads the channels as float, decoding each part once. Fails on truncated or corrupt data.
  void read(std::span<const ExrRead> reads);
  /// Reads `rows` rows of the parts' data windows, from the `first` one on.
  void read(std::span<const ExrRead> reads, int first, int rows);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The formats that a caller of open_image() takes.
enum class Formats {
  of_frames,  // formats that hold depth and normals without loss: frame_formats() lists them
  all,        // also other formats that OpenImageIO reads, such as JPEG
};

/// Opens a picture of any format that is read; the first bytes tell the format, not the ending of the name. `option` is
/// the one that named the file. Fails with ErrorKind::input, naming the file's format and the accepted ones, if it is
/// none of these; also if it is missing or damaged.
ExrFile open_image(const std::string& path, const char* option, Formats formats);

/// The text "OpenEXR, DDS, PNG, NumPy, TIFF, TGA, BMP or Radiance HDR".
const char* frame_formats();

/// The name of a plane of depth made of deep samples: all pixels' first surfaces (`surface` 0), second surfaces ..., by
/// their fronts or, with `back`, by the ends of the bodies behind them. `surface` is below kMostDeepSurfaces.
std::string deep_channel(std::size_t surface, bool back);

/// Fails with ErrorKind::input if planes of that window need too much host memory. Call it before making them, since a
/// header may say anything.
void require_host_room(const std::string& path, const Window& data);

/// A plane to write: one float per pixel of the data window.
struct ExrPlane {
  std::string channel;  // of a copy: it replaces that of the original, or is new
  SampleType type;      // half: rounded to nearest, at most +-65504
  int part = 0;         // of a copy
};

struct ExrOutput {
  Window data;     // of a copy: of the planes' parts, or a part of theirs
  Window display;  // ignored in a copy, like the next: the original's stay
  double pixel_aspect = 1;
  // none, rle, zips, zip, piz, dwaa, dwab; in a copy it holds for parts with planes, and may be keep: unchanged, or zip
  // where that would lose bits
  std::string compression = "zip";
  // attributes of the input to carry over; those that describe its channels and storage are left out; ignored in a copy
  std::shared_ptr<const ExrAttributes> attributes;
  // added as strings, in a copy to the first part and to those of the planes
  std::map<std::string, std::string> own_attributes;
  std::vector<ExrPlane> planes;
  std::string original = {};  // the path of an EXR file to copy; empty: none
};

/// Writes a file from top to bottom: a single part of scan lines, or a copy of an EXR file with some channels replaced
/// or added. The file gets its name when it is finished, and vanishes if it is not.
///
/// Of an original, a part without planes is copied chunk by chunk as it is compressed, also deep samples, tiles and
/// their levels. In a part with planes, all other channels keep their type and every bit, and tiles become scan lines.
/// If the window is smaller than the planes' data window, all flat parts with that data window are cut to it too. Fails
/// with ErrorKind::output, or with ErrorKind::input if the original cannot be read.
class ExrWriter {
 public:
  ExrWriter(const std::string& path, const ExrOutput& output);
  ~ExrWriter();
  ExrWriter(ExrWriter&&) noexcept;

  /// Writes the next rows of every plane, as wide as the data window.
  void write(std::span<const std::span<const float>> planes);
  /// Ends the file after its last row. `late` holds text attributes that were not known at the beginning. Since the
  /// header stands before the rows, the rows are then copied behind a new header, compressed as they are.
  void finish(const std::map<std::string, std::string>& late = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads the named channels of the first part that holds all of them; without names, every channel of the first part.
/// Fails with ErrorKind::input.
Image read_exr_image(const std::string& path, const std::vector<std::string>& channels = {});

/// Gives a text attribute of the first part; nothing if the file is not an EXR, lacks the attribute, or was cut short:
/// some chunk then lies beyond its end.
std::optional<std::string> attribute_of_whole_exr(const std::string& path, const std::string& name);

/// Sets the number of threads that codecs may use in the whole process. 0: only the caller's.
void set_exr_threads(int threads);

/// Sets the bytes that the codec of each file opened from now on may work on. With long rows, fewer threads then work
/// on one file.
void set_exr_memory(std::uint64_t bytes);

/// The most rows that any compression of outputs puts together.
constexpr std::uint64_t kRowsOfOutput = 32;

/// The bytes that a codec works on for groups of rows of `group_bytes` bytes, with the limit of set_exr_memory(), or of
/// `most_bytes`.
std::uint64_t exr_codec_bytes(std::uint64_t group_bytes, std::optional<std::uint64_t> most_bytes = {});

/// Whether DWAA and DWAB lose bits of a channel. They go by the last part of its name.
bool is_lossy_in_dwa(const std::string& channel);

/// The number of an original's rows that are copied at a time.
constexpr std::uint64_t kRowsOfOriginal = 64;

}  // namespace alcove
