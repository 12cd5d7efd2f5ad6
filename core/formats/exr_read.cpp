// Reads EXR files through OpenEXR's C++ API, and ZIP lines and deep samples by our own readers.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfTestFile.h>
#include <ImfThreading.h>
#include <ImfVecAttribute.h>
#include <ImfVersion.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/exr_deep.h"
#include "core/formats/exr_shared.h"
#include "core/formats/exr_zip.h"
#include "core/formats/image_io.h"

namespace alcove {

namespace {

constexpr std::size_t kLongestText = std::size_t(1) << 16;  // bytes given of a text attribute
constexpr std::size_t kMostPixels = std::size_t(1) << 28;   // in host memory: one gigabyte per channel

/// The rows that are compressed together, by the specification of OpenEXR's file layout.
int rows_together(const Imf::Header& header) {
  if (header.hasTileDescription()) return int(header.tileDescription().ySize);
  switch (header.compression()) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION: return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION: return 32;
    case Imf::DWAB_COMPRESSION: return 256;
    default: return 1;
  }
}

/// For each thread OpenEXR keeps two groups of rows, each in three copies: packed, in between, and unpacked.
constexpr std::uint64_t kGroups = 2, kCopies = 3;

std::atomic<std::uint64_t> codec_bytes = std::numeric_limits<std::uint64_t>::max();

/// The bytes that a codec works on with so many threads.
std::uint64_t bytes_of_codec(std::uint64_t group_bytes, int threads) {
  return kCopies * group_bytes * std::max<std::uint64_t>(1, kGroups * std::uint64_t(threads));
}

/// The number of threads that may work on groups of rows of this size within so many bytes.
int threads_for(std::uint64_t group_bytes, std::uint64_t most_bytes) {
  const std::uint64_t of_thread = std::max<std::uint64_t>(1, kCopies * kGroups * group_bytes);
  return int(std::min(most_bytes / of_thread, std::uint64_t(Imf::globalThreadCount())));
}

/// The bytes of the rows of a part that are compressed together.
std::uint64_t group_bytes(const ExrPart& part) {
  std::uint64_t pixel = 0;
  for (const auto& channel : part.channels) pixel += channel.type == SampleType::half_float ? 2 : 4;
  return pixel * std::uint64_t(part.data.width) * std::uint64_t(part.rows_together);
}

const char* name_of(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION: return "none";
    case Imf::RLE_COMPRESSION: return "rle";
    case Imf::ZIPS_COMPRESSION: return "zips";
    default: return "other";
  }
}

DeepLayout deep_layout(const Imf::Header& header) {
  constexpr const char* kStates[] = {"messy", "sorted", "non-overlapping", "tidy"};
  const int state = Imf::hasDeepImageState(header) ? int(Imf::deepImageState(header)) : 0;
  return {state >= 0 && state < int(std::size(kStates)) ? kStates[state] : kStates[0], name_of(header.compression()),
          header.type() == Imf::DEEPTILE};
}

ExrPart describe(const Imf::Header& header) {
  ExrPart part{header.hasName() ? header.name() : std::string(),
               header.hasView() ? header.view() : std::string(),
               {},
               window_of(header.dataWindow()),
               {}};
  part.rows_together = rows_together(header);
  part.dwa = header.compression() == Imf::DWAA_COMPRESSION || header.compression() == Imf::DWAB_COMPRESSION;
  if (header.hasType() && Imf::isDeepData(header.type())) part.deep = deep_layout(header);
  if (Imf::hasMultiView(header)) part.multi_view = Imf::multiView(header);
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const auto& c = channel.channel();
    part.channels.push_back({channel.name(), sample_type_of(c.type), c.xSampling != 1 || c.ySampling != 1});
  }
  return part;
}

std::string text_of(const Imf::Attribute& attribute) {
  if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute))
    return text->value().substr(0, kLongestText);
  if (const auto* number = dynamic_cast<const Imf::FloatAttribute*>(&attribute))
    return fmt::format("{}", number->value());
  if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(&attribute))
    return fmt::format("{}", number->value());
  if (const auto* number = dynamic_cast<const Imf::IntAttribute*>(&attribute))
    return fmt::format("{}", number->value());
  if (const auto* matrix = dynamic_cast<const Imf::M44fAttribute*>(&attribute)) {
    const auto values = std::span(matrix->value().getValue(), 16);
    return fmt::format("{}", fmt::join(values, " "));
  }
  if (const auto* pair = dynamic_cast<const Imf::V2fAttribute*>(&attribute))
    return fmt::format("{} {}", pair->value().x, pair->value().y);
  if (const auto* pair = dynamic_cast<const Imf::V2dAttribute*>(&attribute))
    return fmt::format("{} {}", pair->value().x, pair->value().y);
  if (const auto* numbers = dynamic_cast<const Imf::FloatVectorAttribute*>(&attribute))
    return fmt::format("{}", fmt::join(numbers->value(), " "));
  if (const auto* matrix = dynamic_cast<const Imf::M44dAttribute*>(&attribute))
    return fmt::format("{}", fmt::join(std::span(matrix->value().getValue(), 16), " "));
  return std::string("(") + attribute.typeName() + ")";
}

/// The surface of a deep channel, and whether the channel is its back.
std::optional<std::pair<std::size_t, bool>> place_of_deep(const std::string& channel) {
  for (std::size_t surface = 0; surface < kMostDeepSurfaces; surface++)
    for (const bool back : {false, true})
      if (channel == deep_channel(surface, back)) return std::pair(surface, back);
  return std::nullopt;
}

}  // namespace

struct ExrFile::Impl {
  std::string path, option;
  std::ifstream bytes;  // opened once
  std::unique_ptr<Imf::StdIFStream> stream;
  std::unique_ptr<Imf::MultiPartInputFile> file;
  std::vector<ExrPart> parts;
  Window display;
  double pixel_aspect = 1;
  std::uint64_t group = 0;                 // bytes of the rows that are decoded together; 0 for other formats
  std::uint64_t codec_bytes = 0;           // memory of reading
  int threads = 0;                         // that may decode
  std::unique_ptr<PictureReader> picture;  // instead of `file`, for other formats
  std::unique_ptr<DeepReader> deep;        // after take_deep()
  int deep_part = -1;                      // its first part
  std::uint64_t deep_bytes = 0;            // its memory
  std::uint64_t header_bytes = 0;          // length of the file's header

  void open(int threads_of_codec) {
    stream->clear();
    stream->seekg(0);
    file = std::make_unique<Imf::MultiPartInputFile>(*stream, threads_of_codec);
  }

  /// Opens the file again with fewer threads if all threads would work on more bytes than they may.
  void limit_codec() {
    for (const auto& part : parts)
      if (!part.deep) group = std::max(group, group_bytes(part));
    threads = threads_for(group, alcove::codec_bytes);
    if (threads < Imf::globalThreadCount()) open(threads);
    codec_bytes = bytes_of_codec(group, threads);
  }

  /// Reads rows of channels of one part.
  void read_rows(int part, std::span<const ExrRead> reads, int first, int rows) {
    Imf::InputPart input(*file, part);
    const auto& channels = input.header().channels();
    const auto is_there = [&](const ExrRead& read) { return channels.findChannel(read.channel) != nullptr; };
    if (is_zip_rows(input.header()) && std::ranges::all_of(reads, is_there)) {
      std::vector<ZipRead> of_part;
      for (const auto& read : reads) of_part.push_back({read.channel, read.to});
      return read_zip_rows(input, of_part, first, rows, threads);
    }
    Window band = parts[std::size_t(part)].data;
    band.y += first;
    band.height = rows;
    const std::size_t row_bytes = sizeof(float) * std::size_t(band.width);
    Imf::FrameBuffer frame_buffer;
    for (const auto& read : reads)
      frame_buffer.insert(read.channel, Imf::Slice::Make(Imf::FLOAT, read.to, box_of(band), sizeof(float), row_bytes));
    input.setFrameBuffer(frame_buffer);
    input.readPixels(band.y, band.y + band.height - 1);
  }

  /// Adds the wanted deep parts with the places of their tables of chunks.
  void add_stored_deep(const std::vector<int>& wanted, std::vector<DeepStored>& stored) const {
    std::uint64_t offsets = header_bytes;
    for (int part = 0; part < file->parts(); part++) {
      const auto& header = file->header(part);
      if (std::ranges::find(wanted, part) != wanted.end())
        stored.push_back({path, part, header, offsets, Imf::isMultiPart(file->version())});
      if (header.hasChunkCount()) offsets += sizeof(std::uint64_t) * std::uint64_t(std::max(0, header.chunkCount()));
    }
  }

  /// Reads the channels that are made of deep samples.
  void read_deep(std::span<const ExrRead> reads, int first, int rows) const {
    std::vector<DeepRead> planes;
    for (const auto& read : reads) {
      if (!parts[std::size_t(read.part)].deep) continue;
      const auto place = place_of_deep(read.channel);
      if (read.part != deep_part || !place)
        fail(ErrorKind::input, "{}: channel {} of part {} is deep: it has no single value per pixel ({})", path,
             read.channel, read.part, option);
      planes.push_back({place->first, place->second, read.to});
    }
    if (!planes.empty()) deep->read(planes, first, rows);
  }

  /// Describes a picture of one part with these channels.
  Impl(const std::string& path_, const char* option_, const Window& data, const Window& display_,
       const std::vector<std::string>& names)
      : path(path_), option(option_), parts{{"", "", {}, data, {}}}, display(display_) {
    for (const auto& name : names) parts[0].channels.push_back({name, SampleType::single_float, false});
  }
  Impl() = default;
};

ExrFile::ExrFile(const std::string& path, const char* option) : impl_(std::make_unique<Impl>()) {
  require_readable(path, "EXR", option);
  impl_->path = path;
  impl_->option = option;
  if (!std::filesystem::is_regular_file(path))
    fail(ErrorKind::input, "{}: is no regular file; {} takes an EXR file", path, option);
  try {
    impl_->bytes.open(path, std::ios::binary);
    impl_->stream = std::make_unique<Imf::StdIFStream>(impl_->bytes, path.c_str());
    if (!Imf::isOpenExrFile(*impl_->stream)) fail(ErrorKind::input, "{}: not an OpenEXR file ({})", path, option);
    impl_->header_bytes = require_sane_header(impl_->bytes, path, option);
    impl_->open(Imf::globalThreadCount());
    for (int part = 0; part < impl_->file->parts(); part++) {
      const auto& header = impl_->file->header(part);
      impl_->parts.push_back(describe(header));
      if (impl_->parts.back().channels.empty())
        fail(ErrorKind::input, "{}: part {} has no channels ({})", path, part, option);
    }
    impl_->limit_codec();
    impl_->display = window_of(impl_->file->header(0).displayWindow());
    impl_->pixel_aspect = impl_->file->header(0).pixelAspectRatio();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    fail(ErrorKind::input, "{}: the EXR header cannot be read ({}): {}", path, option, one_line(error));
  }
}

ExrFile::ExrFile(const std::string& path, const char* option, std::unique_ptr<PictureReader> picture)
    : impl_(std::make_unique<Impl>(path, option, picture->data, picture->display, picture->names)) {
  impl_->picture = std::move(picture);
}

void require_host_room(const std::string& path, const Window& data) {
  if (data.pixels() > kMostPixels)
    fail(ErrorKind::input, "{}: {} are too many pixels to read at once; use a smaller frame", path, to_string(data));
}

ExrFile::~ExrFile() = default;
ExrFile::ExrFile(ExrFile&&) noexcept = default;
const std::string& ExrFile::path() const { return impl_->path; }
const std::vector<ExrPart>& ExrFile::parts() const { return impl_->parts; }
const Window& ExrFile::display() const { return impl_->display; }
double ExrFile::pixel_aspect() const { return impl_->pixel_aspect; }

std::shared_ptr<const ExrAttributes> ExrFile::attributes(int part) const {
  auto attributes = std::make_shared<ExrAttributes>();
  if (!impl_->file) return attributes;
  attributes->header = impl_->file->header(part);
  const Imf::Header& first = impl_->file->header(0);
  for (auto attribute = first.begin(); attribute != first.end(); ++attribute)
    if (std::string_view(attribute.name()) != "view" &&
        attributes->header.find(attribute.name()) == attributes->header.end())
      attributes->header.insert(attribute.name(), attribute.attribute());
  return attributes;
}

std::map<std::string, std::string> ExrFile::attribute_texts(int part) const {
  std::map<std::string, std::string> texts;
  if (!impl_->file) return texts;
  const Imf::Header& header = impl_->file->header(part);
  for (auto entry = header.begin(); entry != header.end(); ++entry)
    if (!describes_storage(entry.name())) texts[entry.name()] = text_of(entry.attribute());
  return texts;
}

std::map<std::string, std::string> ExrFile::whole_texts(int part, const std::string& prefix) const {
  std::map<std::string, std::string> texts;
  if (!impl_->file) return texts;
  const Imf::Header& header = impl_->file->header(part);
  for (auto entry = header.begin(); entry != header.end(); ++entry)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&entry.attribute());
        text && std::string_view(entry.name()).starts_with(prefix))
      texts[entry.name()] = text->value();
  return texts;
}

std::uint64_t ExrFile::bytes_beside_pixels() const { return impl_->codec_bytes + impl_->deep_bytes; }

std::uint64_t ExrFile::codec_group() const { return impl_->group; }

std::string deep_channel(std::size_t surface, bool back) {
  return fmt::format("deep{}.{}", surface + 1, back ? "ZBack" : "Z");
}

void ExrFile::take_deep(const std::vector<int>& parts, const DeepRules& rules) {
  take_deep(parts, rules, impl_->parts[std::size_t(parts.front())].data);
}

void ExrFile::take_deep(const std::vector<int>& parts, const DeepRules& rules, const Window& data,
                        std::span<const DeepElement> others) {
  std::vector<DeepStored> stored;
  impl_->add_stored_deep(parts, stored);
  for (const auto& other : others) other.file->impl_->add_stored_deep(other.parts, stored);
  impl_->deep = std::make_unique<DeepReader>(impl_->option.c_str(), data, stored, rules, codec_bytes);
  impl_->deep_part = parts.front();
  impl_->parts[std::size_t(parts.front())].data = data;
  impl_->deep_bytes = impl_->deep->bytes();
}

DeepCounts ExrFile::deep_counts() const { return impl_->deep ? impl_->deep->counts() : DeepCounts{}; }

void ExrFile::close() {
  impl_->file.reset();
  impl_->stream.reset();
  impl_->bytes.close();
  impl_->picture.reset();
  impl_->deep.reset();
}

void ExrFile::read(std::span<const ExrRead> reads) {
  // Parts that are read together cover the same pixels.
  if (!reads.empty()) read(reads, 0, impl_->parts[std::size_t(reads[0].part)].data.height);
}

void ExrFile::read(std::span<const ExrRead> reads, int first, int rows) {
  if (impl_->picture) {
    const auto& names = impl_->picture->names;
    std::vector<PictureReader::Channel> channels;
    for (const auto& read : reads)
      channels.push_back({std::size_t(std::ranges::find(names, read.channel) - names.begin()), read.to});
    return impl_->picture->read(first, rows, channels);
  }
  impl_->read_deep(reads, first, rows);
  std::map<int, std::vector<ExrRead>> parts;
  std::vector<std::pair<ExrRead, const float*>> repeats;  // further reads of a channel, with the first one's plane
  for (const auto& read : reads) {
    if (impl_->parts[std::size_t(read.part)].deep) continue;
    auto& of_part = parts[read.part];
    const auto earlier = std::ranges::find(of_part, read.channel, &ExrRead::channel);
    if (earlier == of_part.end())
      of_part.push_back(read);
    else
      repeats.emplace_back(read, earlier->to);
  }
  for (const auto& [part, of_part] : parts) {
    try {
      impl_->read_rows(part, of_part, first, rows);
    } catch (const std::exception& error) {
      // OpenEXR begins with the file's name, which is said already, and sometimes twice.
      const std::string text = one_line(error);
      const std::size_t named = text.rfind("image file \"" + impl_->path + "\". ");
      const std::size_t from = named == text.npos ? 0 : named + impl_->path.size() + 15;
      fail(ErrorKind::input, "{}: the pixels of part {} cannot be read ({}), the file is damaged or incomplete: {}",
           impl_->path, part, impl_->option, text.substr(from));
    }
  }
  for (const auto& [read, from] : repeats)
    std::copy_n(from, std::size_t(rows) * std::size_t(impl_->parts[std::size_t(read.part)].data.width), read.to);
}

Image read_exr_image(const std::string& path, const std::vector<std::string>& channels) {
  ExrFile file(path, "INPUT");
  const auto has_all = [&](const ExrPart& part) {
    return !part.deep && std::ranges::all_of(channels, [&](const auto& name) {
      return std::ranges::find(part.channels, name, &ExrChannel::name) != part.channels.end();
    });
  };
  const auto part = std::ranges::find_if(file.parts(), has_all);
  if (std::ranges::all_of(file.parts(), [](const ExrPart& each) { return each.deep.has_value(); }))
    fail(ErrorKind::input, "{}: it holds deep data only, which has no single value per pixel: flatten it first", path);
  if (part == file.parts().end()) fail(ErrorKind::input, "{}: no part has the channels {}", path, list_of(channels));
  std::vector<std::string> names = channels;
  if (names.empty()) std::ranges::transform(part->channels, std::back_inserter(names), &ExrChannel::name);
  require_host_room(path, part->data);
  Image image(part->data, file.display(), names);
  std::vector<ExrRead> reads;
  for (std::size_t i = 0; i < names.size(); i++)
    reads.push_back({int(part - file.parts().begin()), names[i], image.plane(i).data()});
  file.read(reads);
  return image;
}

void set_exr_threads(int threads) { Imf::setGlobalThreadCount(threads); }

void set_exr_memory(std::uint64_t bytes) { codec_bytes = bytes; }

std::uint64_t exr_codec_bytes(std::uint64_t group_bytes, std::optional<std::uint64_t> most_bytes) {
  return bytes_of_codec(group_bytes, threads_for(group_bytes, most_bytes.value_or(codec_bytes)));
}

}  // namespace alcove
