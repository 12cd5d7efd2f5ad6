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
#include <ImfIO.h>
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
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/exr_shared.h"
#include "core/formats/exr_zip.h"
#include "core/formats/sample_loops.h"

namespace alcove {

/// An output stream into a file in the making. OpenEXR swallows failures while it closes a file; run() throws them.
class FileStream : public Imf::OStream {
 public:
  explicit FileStream(const std::string& path) : Imf::OStream(path.c_str()), file_(path) {}
  void write(const char data[], int count) override {
    try {
      file_.write_at(position_, {data, std::size_t(count)});
    } catch (const Error& error) {
      if (!failure_) failure_ = error;
      throw;
    }
    position_ += std::uint64_t(count);
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  void commit() { file_.commit(); }
  const std::string& temporary() const { return file_.temporary(); }

  /// Runs a step of writing. If the stream failed, its error is thrown, since OpenEXR does not tell the reason. An
  /// Error about a file that is read for it passes.
  template <class Step>
  void run(const Step& step) {
    try {
      step();
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      if (!failure_) fail(ErrorKind::output, "{}: could not be encoded: {}", fileName(), one_line(error));
    }
    if (failure_) throw *failure_;
  }

 private:
  NewFile file_;
  std::uint64_t position_ = 0;
  std::optional<Error> failure_;
};

namespace {

/// Whether an attribute records how Alcove made the input, which does not hold for an output made from it.
bool is_own_attribute(std::string_view name) { return name.starts_with("alcove/"); }

/// The compression of that name, as in ExrOutput; ZIP for unknown names.
Imf::Compression compression_of(const std::string& name) {
  if (name == "none") return Imf::NO_COMPRESSION;
  if (name == "rle") return Imf::RLE_COMPRESSION;
  if (name == "zips") return Imf::ZIPS_COMPRESSION;
  if (name == "piz") return Imf::PIZ_COMPRESSION;
  if (name == "dwaa") return Imf::DWAA_COMPRESSION;
  if (name == "dwab") return Imf::DWAB_COMPRESSION;
  return Imf::ZIP_COMPRESSION;
}

Imf::PixelType pixel_type_of(SampleType type) { return type == SampleType::half_float ? Imf::HALF : Imf::FLOAT; }

/// Rows of a plane as OpenEXR takes them; `halves` keeps the converted ones. Values are rounded to the nearest half;
/// beyond half's range they become its largest value, not infinity.
Imf::Slice slice_of(const Window& rows, SampleType type, std::span<const float> pixels,
                    std::deque<std::vector<std::uint16_t>>& halves) {
  const bool is_half = type == SampleType::half_float;
  const std::size_t bytes = is_half ? sizeof(std::uint16_t) : sizeof(float);
  if (is_half) narrow(pixels.data(), pixels.size(), halves.emplace_back(pixels.size()).data());
  const void* values = is_half ? static_cast<const void*>(halves.back().data()) : pixels.data();
  return Imf::Slice::Make(pixel_type_of(type), values, box_of(rows), bytes, bytes * std::size_t(rows.width));
}

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

struct ExrWriter::Impl {
  ExrOutput output;
  FileStream stream;
  std::unique_ptr<Imf::MultiPartInputFile> original;                // of a copy
  std::vector<bool> by_rows;                                        // one per part of it; false: by chunks
  std::map<std::pair<int, std::string>, std::vector<char>> passed;  // rows of its unchanged channels
  std::unique_ptr<ZipWriter> zip;                                   // if the only part is ZIP lines
  std::unique_ptr<Imf::MultiPartOutputFile> parts;                  // of any other copy
  std::unique_ptr<Imf::OutputFile> lines;                           // of any other file
  int rows = 0;                                                     // written so far

  Impl(const std::string& path, const ExrOutput& output_) : output(output_), stream(path) {}

  /// Runs a step that reads the original.
  template <class Function>
  void read(Function&& function) {
    try {
      function();
    } catch (const std::exception& error) {
      fail(ErrorKind::input, "{}: could not be read for the composite: {}", output.original, one_line(error));
    }
  }

  bool has_planes(int part) const {
    return std::ranges::find(output.planes, part, &ExrPlane::part) != output.planes.end();
  }

  void open() {
    read([&] { original = std::make_unique<Imf::MultiPartInputFile>(output.original.c_str()); });
    const Window whole = window_of(original->header(output.planes.front().part).dataWindow());
    for (int part = 0; part < original->parts(); part++) {
      const Imf::Header& header = original->header(part);
      const bool is_flat = type_of(header) == Imf::SCANLINEIMAGE || type_of(header) == Imf::TILEDIMAGE;
      const bool is_cut = output.data != whole && is_flat && window_of(header.dataWindow()) == whole;
      by_rows.push_back(has_planes(part) || is_cut);
    }
  }

  Imf::Header copied_header(int part) const {
    Imf::Header header = original->header(part);
    std::vector<std::string> stale;
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
      if (is_own_attribute(attribute.name())) stale.push_back(attribute.name());
    if (by_rows[std::size_t(part)]) stale.insert(stale.end(), {"tiles", "chunkCount"});
    for (const auto& name : stale) header.erase(name);
    if (by_rows[std::size_t(part)]) {
      if (header.hasType()) header.setType(Imf::SCANLINEIMAGE);
      header.lineOrder() = Imf::INCREASING_Y;
      header.dataWindow() = box_of(output.data);
      if (loses(header.compression())) header.compression() = Imf::ZIP_COMPRESSION;
    }
    const bool is_changed = has_planes(part);
    if (is_changed && output.compression != "keep") header.compression() = compression_of(output.compression);
    for (const auto& plane : output.planes)
      if (plane.part == part && !header.channels().findChannel(plane.channel))
        header.channels().insert(plane.channel, Imf::Channel(pixel_type_of(plane.type)));
    if (is_changed || part == 0)
      for (const auto& [name, value] : output.own_attributes) header.insert(name, Imf::StringAttribute(value));
    return header;
  }

  std::vector<Imf::Header> headers() const {
    if (!original) return {header_of(output)};
    std::vector<Imf::Header> of_parts;
    for (int part = 0; part < original->parts(); part++) of_parts.push_back(copied_header(part));
    return of_parts;
  }

  /// Whether ZipWriter writes the only part. It does not write integer channels, which OpenEXR refuses.
  bool is_for_zip(const Imf::Header& header) const {
    if (!original) return output.compression.starts_with("zip");
    const auto is_integer = [&](const ExrPlane& plane) {
      return header.channels()[plane.channel.c_str()].type == Imf::UINT;
    };
    return original->parts() == 1 && by_rows[0] && is_zip_rows(header) &&
           output.data == window_of(original->header(0).dataWindow()) &&
           std::ranges::none_of(output.planes, is_integer);
  }

  void begin() {
    const std::vector<Imf::Header> of_parts = headers();
    if (is_for_zip(of_parts[0]))
      zip = std::make_unique<ZipWriter>(stream, of_parts[0]);
    else if (original)
      parts = std::make_unique<Imf::MultiPartOutputFile>(stream, of_parts.data(), int(of_parts.size()));
    else
      lines = std::make_unique<Imf::OutputFile>(stream, of_parts[0]);
  }

  /// Reads rows of all unchanged channels of a part, and adds them to the buffer to write.
  void read_rows(int part, const Window& band, Imf::FrameBuffer& to) {
    std::set<std::string> replaced;
    for (const auto& plane : output.planes)
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
    if (original) read_rows(0, band, ignored);
    std::vector<ZipWriter::Source> sources;
    const auto& channels = zip->header().channels();
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      const auto plane = std::ranges::find(output.planes, std::string_view(at.name()), &ExrPlane::channel);
      if (plane != output.planes.end())
        sources.push_back({planes[std::size_t(plane - output.planes.begin())].data(), true});
      else
        sources.push_back({passed.at({0, at.name()}).data(), false});
    }
    zip->write(sources, std::size_t(band.height));
  }

  /// Writes the rows of `band` of every part that is written by rows; `planes` has a slice for each plane.
  void write_rows(const Window& band, const std::vector<Imf::Slice>& planes) {
    for (int part = 0; part < (original ? original->parts() : 1); part++) {
      if (original && !by_rows[std::size_t(part)]) continue;
      Imf::FrameBuffer rows_of_part;
      for (std::size_t i = 0; i < planes.size(); i++)
        if (output.planes[i].part == part) rows_of_part.insert(output.planes[i].channel, planes[i]);
      const auto write = [&](auto&& to) {
        to.setFrameBuffer(rows_of_part);
        to.writePixels(band.height);
      };
      if (lines) {
        write(*lines);
      } else {
        read_rows(part, band, rows_of_part);
        write(Imf::OutputPart(*parts, part));
      }
    }
  }

  void end() {
    for (int part = 0; original && part < original->parts(); part++)
      if (!by_rows[std::size_t(part)]) copy_chunks(*original, *parts, part);
    if (zip) zip->finish();
    parts.reset();
    lines.reset();
  }

  /// Copies the chunks of the finished file into another one, behind new headers.
  void copy_to(FileStream& to) const {
    const std::vector<Imf::Header> of_parts = headers();
    if (!original) {
      Imf::InputFile from(stream.temporary().c_str());
      return Imf::OutputFile(to, of_parts[0]).copyPixels(from);
    }
    Imf::MultiPartOutputFile copy(to, of_parts.data(), int(of_parts.size()));
    Imf::MultiPartInputFile whole(stream.temporary().c_str());
    for (int part = 0; part < whole.parts(); part++) copy_chunks(whole, copy, part);
  }
};

ExrWriter::ExrWriter(const std::string& path, const ExrOutput& output) : impl_(std::make_unique<Impl>(path, output)) {
  if (!output.original.empty()) impl_->open();
  impl_->stream.run([&] { impl_->begin(); });
}
ExrWriter::~ExrWriter() = default;
ExrWriter::ExrWriter(ExrWriter&&) noexcept = default;

void ExrWriter::write(std::span<const std::span<const float>> planes) {
  const ExrOutput& output = impl_->output;
  const int width = output.data.width, height = int(planes[0].size() / std::size_t(width));
  const int step = impl_->original ? int(kRowsOfOriginal) : height;
  for (int done = 0; done < height; done += step) {
    const Window band{output.data.x, output.data.y + impl_->rows + done, width, std::min(step, height - done)};
    std::vector<std::span<const float>> rows;
    for (const auto& plane : planes)
      rows.push_back(plane.subspan(std::size_t(done) * std::size_t(width), band.pixels()));
    std::deque<std::vector<std::uint16_t>> halves;
    std::vector<Imf::Slice> slices;
    for (std::size_t i = 0; !impl_->zip && i < rows.size(); i++)
      slices.push_back(slice_of(band, output.planes[i].type, rows[i], halves));
    impl_->stream.run([&] { impl_->zip ? impl_->write_zip(band, rows) : impl_->write_rows(band, slices); });
  }
  impl_->rows += height;
}

void ExrWriter::finish(const std::map<std::string, std::string>& late) {
  impl_->stream.run([&] { impl_->end(); });
  if (late.empty()) return impl_->stream.commit();
  for (const auto& [name, value] : late) impl_->output.own_attributes[name] = value;
  FileStream with_late(impl_->stream.fileName());
  with_late.run([&] { impl_->copy_to(with_late); });
  with_late.commit();
}

}  // namespace alcove
