// OpenEXR files in and out: headers, chosen channels in one pass, whole files. Other pictures are read like them.
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

/// How a deep part is stored, in the words of OpenEXR.
struct DeepLayout {
  std::string state;  // of its samples: messy, sorted, non-overlapping or tidy; what is not said is messy
  std::string compression;
  bool is_tiled = false;
};

struct ExrPart {
  std::string name;  // empty in single-part files
  std::string view;  // of stereo files that have one part per view; empty: none
  // the views of stereo files whose channels name their view, the default first; empty: none
  std::vector<std::string> multi_view;
  Window data;
  std::vector<ExrChannel> channels;
  int rows_together = 1;  // that are compressed together: a multiple of them is decoded without waste
  // of a part that has several samples a pixel, or none: its channels are no planes; see ExrFile::take_deep()
  std::optional<DeepLayout> deep = {};
  bool dwa = false;  // compressed by DWAA or DWAB, which are lossy for channels whose name ends in R, G, B, Y, RY or BY
};

/// The attributes of one part's header, of every type, and those that only the first part has. They are carried into
/// outputs.
class ExrAttributes;
class PictureReader;

/// A channel to read and its destination: one float per pixel of the part's data window, or of some of its rows, row by
/// row.
struct ExrRead {
  int part;
  std::string channel;
  float* to;
};

class ExrFile;

/// Deep parts of another file, whose samples count together with those of one.
struct DeepElement {
  const ExrFile* file;
  std::vector<int> parts;
};

/// An EXR file whose header has been read. Every failure is ErrorKind::input and names the file.
class ExrFile {
 public:
  /// Fails on a missing file, a folder, a file that is no EXR, a part without channels, and headers that ask for more
  /// than their file can hold.
  explicit ExrFile(const std::string& path, const char* option);
  /// A picture of another format, to be read like an EXR of one part.
  ExrFile(const std::string& path, const char* option, std::unique_ptr<PictureReader> picture);
  ~ExrFile();
  ExrFile(ExrFile&&) noexcept;

  const std::string& path() const;
  const std::vector<ExrPart>& parts() const;
  const Window& display() const;
  /// The width of a pixel over its height.
  double pixel_aspect() const;
  std::shared_ptr<const ExrAttributes> attributes(int part) const;
  /// Gives as text the attributes of a part that do not describe its storage. Numbers, strings and matrices are given
  /// by value, of which the first 64 KiB count, and all else by type.
  std::map<std::string, std::string> attribute_texts(int part) const;
  /// Gives the attributes that are texts and whose names begin so, whole, whatever they describe.
  std::map<std::string, std::string> whole_texts(int part, const std::string& prefix) const;

  /// The most that codecs work on while the file is read, in bytes.
  std::uint64_t bytes_beside_pixels() const;
  /// The bytes of the rows that are decoded together; 0 where no EXR file is read.
  std::uint64_t codec_group() const;
  /// Gives back what reading takes. From then on only parts, windows and that number are there.
  void close();

  /// The samples of these deep parts and of those of other files, all together, make the channels deep_channel() of
  /// the first of them from now on, over these pixels, which become the data window of that part. A part need not have
  /// all of them. Fails where a part has no Z, and where chunks claim more than their file can hold.
  void take_deep(const std::vector<int>& parts, const DeepRules& rules, const Window& data,
                 std::span<const DeepElement> others = {});
  /// The same over the window of the first part.
  void take_deep(const std::vector<int>& parts, const DeepRules& rules);
  /// What was met in the deep samples that were read so far.
  DeepCounts deep_counts() const;

  /// Reads the channels as float, each part decoded once. Fails on truncated or corrupt data.
  void read(std::span<const ExrRead> reads);
  /// Reads only `rows` rows of the parts' data windows, from the `first` one on.
  void read(std::span<const ExrRead> reads, int first, int rows);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The formats that a reader of a file can use.
enum class Formats {
  of_frames,  // those that hold depth and normals without loss: the ones that frame_formats() lists
  all,        // also what else OpenImageIO reads, such as JPEG
};

/// Opens a picture of every format that is read; its first bytes tell the format, whatever its name ends in. `option`
/// says where the user named the file. Fails with ErrorKind::input, naming the file's format and those that are read,
/// if it is none of these; also if it is missing or damaged.
ExrFile open_image(const std::string& path, const char* option, Formats formats);

/// "OpenEXR, DDS, PNG, TIFF, TGA, BMP or Radiance HDR"
const char* frame_formats();

/// The name of a plane of depth that samples make: of the fronts of all pixels' first surfaces, of the second ones ...;
/// or of where the bodies behind these fronts end. `surface` is below kMostDeepSurfaces.
std::string deep_channel(std::size_t surface, bool back);

/// Fails with ErrorKind::input if planes of that window are too much for host memory. It is asked before they are made,
/// since a header may say anything.
void require_host_room(const std::string& path, const Window& data);

/// A plane to write: one float per pixel of the data window.
struct ExrPlane {
  std::string channel;
  SampleType type;  // half: rounded to nearest, at most +-65504
  std::span<const float> pixels;
};

struct ExrOutput {
  Window data, display;
  double pixel_aspect = 1;
  std::string compression = "zip";  // none, rle, zips, zip, piz, dwaa, dwab
  // carried over, but those that describe the input's own channels and storage
  std::shared_ptr<const ExrAttributes> attributes;
  std::map<std::string, std::string> own_attributes;  // added as strings
  std::vector<ExrPlane> planes;
};

/// Writes a single-part scan-line file from top to bottom. The file has its name once it is finished, and is gone if it
/// is not. Fails with ErrorKind::output.
class ExrWriter {
 public:
  /// Ignores the pixels of output.planes.
  ExrWriter(const std::string& path, const ExrOutput& output);
  ~ExrWriter();
  ExrWriter(ExrWriter&&) noexcept;

  /// Writes the next rows of every plane, as wide as the data window.
  void write(std::span<const std::span<const float>> planes);
  /// Ends the file after its last row. `late` holds attributes, as text, that were not known when the file was begun:
  /// since its header stands before its rows, these are copied behind a new one, compressed as they are.
  void finish(const std::map<std::string, std::string>& late = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a whole file with the pixels of output.planes.
void write_exr(const std::string& path, const ExrOutput& output);

/// Reads the named channels, from the first part that holds all of them; without names, every channel of the first
/// part. Fails with ErrorKind::input.
Image read_exr_image(const std::string& path, const std::vector<std::string>& channels = {});

/// Gives a text attribute of the first part of a file that is whole, with every chunk within it; a file that was cut
/// short shows it in no other way. Gives nothing if the file is cut, is no EXR, or has no such attribute.
std::optional<std::string> attribute_of_whole_exr(const std::string& path, const std::string& name);

/// Sets how many threads the codecs may use in the whole process. 0: none beside the caller's.
void set_exr_threads(int threads);

/// Sets how many bytes the codec of each file that is opened from now on may work on: where rows are long, fewer
/// threads work on one file then.
void set_exr_memory(std::uint64_t bytes);

/// The most rows that any compression of outputs puts together.
constexpr std::uint64_t kRowsOfOutput = 32;

/// The bytes that a codec works on of which a group of rows takes so many: as set_exr_memory() has it, or where it may
/// work on `most_bytes`.
std::uint64_t exr_codec_bytes(std::uint64_t group_bytes, std::optional<std::uint64_t> most_bytes = {});

/// A channel that is written: one float per pixel of the window. It replaces that of the original, or is a new one.
struct CopiedPlane {
  int part;
  std::string channel;
  SampleType type;
};

struct ExrCopySettings {
  std::string original;  // the file's path
  Window window;         // that is written of the parts below; the data window of the planes' parts, or a part of it
  std::string compression = "keep";  // of the planes' parts: as in ExrOutput; keep: as it is, or zip if that loses bits
  std::vector<CopiedPlane> planes;   // at least one
  std::map<std::string, std::string> own_attributes;  // added as strings to the first part and to those of the planes
};

/// Writes the copy from top to bottom; it has its name once it is finished, and is gone if it is not.
///
/// A part without planes is copied chunk by chunk as it is compressed, deep samples, tiles and their levels too. In a
/// part with planes all other channels keep their type and every bit, and its tiles become scan lines. Where the window
/// is smaller than the planes' data window, so are all flat parts that have this data window. Fails with
/// ErrorKind::output, or with ErrorKind::input where the original cannot be read.
class ExrCopy {
 public:
  ExrCopy(const std::string& path, const ExrCopySettings& settings);
  ~ExrCopy();
  ExrCopy(ExrCopy&&) noexcept;

  /// The next rows of every plane, as wide as the window.
  void write(std::span<const std::span<const float>> planes);
  /// Ends the file after its last row, as ExrWriter::finish() does.
  void finish(const std::map<std::string, std::string>& late = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether DWAA and DWAB lose bits of a channel, which they judge by the last part of its name.
bool is_lossy_in_dwa(const std::string& channel);

/// The rows of an original that are copied at a time.
constexpr std::uint64_t kRowsOfOriginal = 64;

}  // namespace alcove
