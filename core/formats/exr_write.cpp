// Writes EXR files, and copies with some channels replaced. Both go into a stream that keeps its failures.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr.h"

#include <ImfChannelList.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputPart.h>

#include <algorithm>
#include <deque>
#include <set>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/exr_shared.h"
#include "core/formats/exr_zip.h"
#include "core/formats/sample_loops.h"

namespace alcove {

namespace {

Imf::Header header_of(const ExrOutput& output) {
  Imf::Header header(box_of(output.display), box_of(output.data), float(output.pixel_aspect));
  header.compression() = compression_of(output.compression);
  if (output.attributes)
    for (auto attribute = output.attributes->header.begin(); attribute != output.attributes->header.end(); ++attribute)
      if (!describes_storage(attribute.name()) && !is_own_attribute(attribute.name()))
        header.insert(attribute.name(), attribute.attribute());
  for (const auto& [name, value] : output.own_attributes) {
    header.erase(name);  // the input's may be of another type
    header.insert(name, Imf::StringAttribute(value));
  }
  for (const auto& plane : output.planes)
    header.channels().insert(plane.channel, Imf::Channel(pixel_type_of(plane.type)));
  return header;
}

}  // namespace

struct ExrWriter::Impl {
  std::string path;
  ExrOutput output;
  FileStream stream;
  std::unique_ptr<ZipWriter> zip;
  std::unique_ptr<Imf::OutputFile> file;  // for other compressions than ZIP
  int rows = 0;                           // written so far

  Impl(const std::string& path_, const ExrOutput& output_) : path(path_), output(output_), stream(path_) {}

  void begin() {
    if (output.compression == "zip" || output.compression == "zips")
      zip = std::make_unique<ZipWriter>(stream, header_of(output));
    else
      file = std::make_unique<Imf::OutputFile>(stream, header_of(output));
  }

  void write_zip(std::span<const std::span<const float>> planes) {
    std::vector<ZipWriter::Source> sources;
    const auto& channels = zip->header().channels();
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      const auto plane = std::ranges::find(output.planes, std::string_view(at.name()), &ExrPlane::channel);
      sources.push_back({planes[std::size_t(plane - output.planes.begin())].data(), true});
    }
    run([&] { zip->write(sources, planes[0].size() / std::size_t(output.data.width)); });
  }

  void end() {
    if (zip) zip->finish();
    file.reset();
  }

  template <class Function>
  void run(Function&& function) {
    run_writing(stream, path, function);
  }
};

ExrWriter::ExrWriter(const std::string& path, const ExrOutput& output) : impl_(std::make_unique<Impl>(path, output)) {
  impl_->run([&] { impl_->begin(); });
}
ExrWriter::~ExrWriter() = default;
ExrWriter::ExrWriter(ExrWriter&&) noexcept = default;

void ExrWriter::write(std::span<const std::span<const float>> planes) {
  if (impl_->zip) return impl_->write_zip(planes);
  Window band = impl_->output.data;
  band.y += impl_->rows;
  band.height = int(planes[0].size() / std::size_t(band.width));
  std::deque<std::vector<std::uint16_t>> halves;
  Imf::FrameBuffer frame_buffer;
  for (std::size_t i = 0; i < planes.size(); i++) {
    const ExrPlane& plane = impl_->output.planes[i];
    frame_buffer.insert(plane.channel, slice_of(band, plane.type, planes[i], halves));
  }
  impl_->run([&] {
    impl_->file->setFrameBuffer(frame_buffer);
    impl_->file->writePixels(band.height);
  });
  impl_->rows += band.height;
}

void ExrWriter::finish(const std::map<std::string, std::string>& late) {
  impl_->run([&] { impl_->end(); });
  if (late.empty()) return impl_->stream.commit();
  for (const auto& [name, value] : late) impl_->output.own_attributes[name] = value;
  Impl with_late(impl_->path, impl_->output);
  with_late.run([&] {
    Imf::InputFile rows(impl_->stream.temporary().c_str());
    Imf::OutputFile(with_late.stream, header_of(with_late.output)).copyPixels(rows);
  });
  with_late.stream.commit();
}

namespace {

/// Whether encoding again changes numbers that were encoded once.
bool loses(Imf::Compression compression) {
  return compression == Imf::B44_COMPRESSION || compression == Imf::B44A_COMPRESSION ||
         compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
}

std::string type_of(const Imf::Header& header) {
  if (header.hasType()) return header.type();
  return header.hasTileDescription() ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE;
}

/// Copies the compressed chunks of a part.
void copy_chunks(Imf::MultiPartInputFile& from, Imf::MultiPartOutputFile& to, int part) {
  const std::string type = type_of(from.header(part));
  const auto copy = [&](auto input, auto output) { output.copyPixels(input); };
  if (type == Imf::DEEPSCANLINE)
    copy(Imf::DeepScanLineInputPart(from, part), Imf::DeepScanLineOutputPart(to, part));
  else if (type == Imf::DEEPTILE)
    copy(Imf::DeepTiledInputPart(from, part), Imf::DeepTiledOutputPart(to, part));
  else if (type == Imf::TILEDIMAGE)
    copy(Imf::TiledInputPart(from, part), Imf::TiledOutputPart(to, part));
  else
    copy(Imf::InputPart(from, part), Imf::OutputPart(to, part));
}

}  // namespace

bool is_lossy_in_dwa(const std::string& channel) {
  static const std::set<std::string> kNames{"r", "g", "b", "y", "ry", "by"};
  const std::size_t dot = channel.rfind('.');
  return kNames.contains(lower_case(dot == channel.npos ? channel : channel.substr(dot + 1)));
}

struct ExrCopy::Impl {
  std::string path;
  ExrCopySettings settings;
  FileStream stream;
  std::unique_ptr<Imf::MultiPartInputFile> original;
  std::unique_ptr<ZipWriter> zip;                                   // if the only part is ZIP lines
  std::unique_ptr<Imf::MultiPartOutputFile> file;                   // otherwise
  std::vector<bool> by_rows;                                        // one per part; false: by chunks
  std::map<std::pair<int, std::string>, std::vector<char>> passed;  // rows of unchanged channels
  int rows = 0;                                                     // written so far

  Impl(const std::string& path_, const ExrCopySettings& settings_) : path(path_), settings(settings_), stream(path_) {}

  /// Runs a step that reads the original.
  template <class Function>
  void read(Function&& function) {
    try {
      function();
    } catch (const std::exception& error) {
      fail(ErrorKind::input, "{}: could not be read for the composite: {}", settings.original, one_line(error));
    }
  }

  template <class Function>
  void run(Function&& function) {
    run_writing(stream, path, function);
  }

  bool has_planes(int part) const {
    return std::ranges::any_of(settings.planes, [&](const CopiedPlane& plane) { return plane.part == part; });
  }

  void open() {
    read([&] { original = std::make_unique<Imf::MultiPartInputFile>(settings.original.c_str()); });
    const Window whole = window_of(original->header(settings.planes.front().part).dataWindow());
    for (int part = 0; part < original->parts(); part++) {
      const Imf::Header& header = original->header(part);
      const bool is_flat = type_of(header) == Imf::SCANLINEIMAGE || type_of(header) == Imf::TILEDIMAGE;
      const bool is_cut = settings.window != whole && is_flat && window_of(header.dataWindow()) == whole;
      by_rows.push_back(has_planes(part) || is_cut);
    }
  }

  Imf::Header header_of(int part) const {
    Imf::Header header = original->header(part);
    std::vector<std::string> stale;
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
      if (is_own_attribute(attribute.name())) stale.push_back(attribute.name());
    if (by_rows[std::size_t(part)]) stale.insert(stale.end(), {"tiles", "chunkCount"});
    for (const auto& name : stale) header.erase(name);
    if (by_rows[std::size_t(part)]) {
      if (header.hasType()) header.setType(Imf::SCANLINEIMAGE);
      header.lineOrder() = Imf::INCREASING_Y;
      header.dataWindow() = box_of(settings.window);
      if (loses(header.compression())) header.compression() = Imf::ZIP_COMPRESSION;
    }
    const bool is_changed = has_planes(part);
    if (is_changed && settings.compression != "keep") header.compression() = compression_of(settings.compression);
    for (const auto& plane : settings.planes)
      if (plane.part == part && !header.channels().findChannel(plane.channel))
        header.channels().insert(plane.channel, Imf::Channel(pixel_type_of(plane.type)));
    if (is_changed || part == 0)
      for (const auto& [name, value] : settings.own_attributes) header.insert(name, Imf::StringAttribute(value));
    return header;
  }

  /// Whether ZipWriter writes the only part. It does not write integer channels, which OpenEXR refuses.
  bool is_for_zip(const Imf::Header& header) const {
    const auto is_integer = [&](const CopiedPlane& plane) {
      return header.channels()[plane.channel.c_str()].type == Imf::UINT;
    };
    return is_zip_rows(header) && settings.window == window_of(original->header(0).dataWindow()) &&
           std::ranges::none_of(settings.planes, is_integer);
  }

  /// `copies_chunks`: the chunks come from a file that is whole already.
  void begin(bool copies_chunks = false) {
    std::vector<Imf::Header> headers;
    for (int part = 0; part < original->parts(); part++) headers.push_back(header_of(part));
    if (!copies_chunks && headers.size() == 1 && by_rows[0] && is_for_zip(headers[0]))
      zip = std::make_unique<ZipWriter>(stream, headers[0]);
    else
      file = std::make_unique<Imf::MultiPartOutputFile>(stream, headers.data(), int(headers.size()));
  }

  /// Reads rows of all unchanged channels of a part, and adds them to the buffer to write.
  void read_rows(int part, const Window& band, Imf::FrameBuffer& to) {
    std::set<std::string> replaced;
    for (const auto& plane : settings.planes)
      if (plane.part == part) replaced.insert(plane.channel);
    const Imf::Header& header = original->header(part);
    const Window whole = window_of(header.dataWindow());
    const Window rows_of_original{whole.x, band.y, whole.width, band.height};
    Imf::FrameBuffer from;
    std::vector<ZipRead> reads;
    for (auto at = header.channels().begin(); at != header.channels().end(); ++at) {
      if (replaced.contains(at.name())) continue;
      const Imf::Channel& channel = at.channel();
      const std::size_t bytes = bytes_of(channel.type);
      std::vector<char>& samples = passed[{part, at.name()}];
      samples.resize(bytes * rows_of_original.pixels());
      // For reading and for writing, the slice begins at the same sample.
      const auto slice = Imf::Slice::Make(channel.type, samples.data(), box_of(rows_of_original), bytes, 0,
                                          channel.xSampling, channel.ySampling);
      from.insert(at.name(), slice);
      reads.push_back({at.name(), samples.data(), false});
      to.insert(at.name(), slice);
    }
    if (from.begin() == from.end()) return;
    read([&] {
      Imf::InputPart input(*original, part);
      if (is_zip_rows(header))
        return read_zip_rows(input, reads, band.y - whole.y, band.height, Imf::globalThreadCount());
      input.setFrameBuffer(from);
      input.readPixels(band.y, band.y + band.height - 1);
    });
  }

  /// Writes the rows of `band`; the planes begin with its first row.
  void write_zip(const Window& band, std::span<const std::span<const float>> planes) {
    Imf::FrameBuffer ignored;
    read_rows(0, band, ignored);
    std::vector<ZipWriter::Source> sources;
    const auto& channels = zip->header().channels();
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      const auto plane = std::ranges::find(settings.planes, std::string_view(at.name()), &CopiedPlane::channel);
      if (plane != settings.planes.end())
        sources.push_back({planes[std::size_t(plane - settings.planes.begin())].data(), true});
      else
        sources.push_back({passed.at({0, at.name()}).data(), false});
    }
    zip->write(sources, std::size_t(band.height));
  }

  /// Writes the rows of `band` of every part that is copied by rows; `planes` has a slice for each plane.
  void write_rows(const Window& band, const std::vector<Imf::Slice>& planes) {
    for (int part = 0; part < original->parts(); part++) {
      if (!by_rows[std::size_t(part)]) continue;
      Imf::FrameBuffer rows_of_part;
      for (std::size_t i = 0; i < planes.size(); i++)
        if (settings.planes[i].part == part) rows_of_part.insert(settings.planes[i].channel, planes[i]);
      read_rows(part, band, rows_of_part);
      Imf::OutputPart output(*file, part);
      output.setFrameBuffer(rows_of_part);
      output.writePixels(band.height);
    }
  }
};

ExrCopy::ExrCopy(const std::string& path, const ExrCopySettings& settings)
    : impl_(std::make_unique<Impl>(path, settings)) {
  impl_->open();
  impl_->run([&] { impl_->begin(); });
}
ExrCopy::~ExrCopy() = default;
ExrCopy::ExrCopy(ExrCopy&&) noexcept = default;

void ExrCopy::write(std::span<const std::span<const float>> planes) {
  Window band = impl_->settings.window;
  band.y += impl_->rows;
  band.height = int(planes[0].size() / std::size_t(band.width));
  std::deque<std::vector<std::uint16_t>> halves;
  std::vector<Imf::Slice> slices;
  for (std::size_t i = 0; !impl_->zip && i < planes.size(); i++)
    slices.push_back(slice_of(band, impl_->settings.planes[i].type, planes[i], halves));
  for (int done = 0; done < band.height; done += int(kRowsOfOriginal)) {
    const Window part{band.x, band.y + done, band.width, std::min(int(kRowsOfOriginal), band.height - done)};
    std::vector<std::span<const float>> rows;
    for (const auto& plane : planes) rows.push_back(plane.subspan(std::size_t(done) * std::size_t(band.width)));
    impl_->run([&] { impl_->zip ? impl_->write_zip(part, rows) : impl_->write_rows(part, slices); });
  }
  impl_->rows += band.height;
}

void ExrCopy::finish(const std::map<std::string, std::string>& late) {
  impl_->run([&] {
    for (int part = 0; part < impl_->original->parts(); part++)
      if (!impl_->by_rows[std::size_t(part)]) copy_chunks(*impl_->original, *impl_->file, part);
    if (impl_->zip) impl_->zip->finish();
    impl_->file.reset();
  });
  if (late.empty()) return impl_->stream.commit();
  for (const auto& [name, value] : late) impl_->settings.own_attributes[name] = value;
  Impl with_late(impl_->path, impl_->settings);
  with_late.open();
  with_late.run([&] {
    with_late.begin(true);
    Imf::MultiPartInputFile whole(impl_->stream.temporary().c_str());
    for (int part = 0; part < whole.parts(); part++) copy_chunks(whole, *with_late.file, part);
    with_late.file.reset();
  });
  with_late.stream.commit();
}

}  // namespace alcove
