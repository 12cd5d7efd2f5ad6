// Writes EXR files into a stream that keeps what fails: ZIP by ourselves, all else through OpenEXR.
// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <deque>
#include <set>

#include "core/base/error.h"
#include "core/formats/exr.h"
#include "core/formats/exr_shared.h"
#include "core/formats/exr_zip.h"
#include "core/formats/sample_loops.h"

namespace alcove {

/// Gives OpenEXR's description of an error on one line.
std::string one_line(const std::exception& error) {
  std::string text = error.what();
  std::ranges::replace(text, '\n', ' ');
  return text;
}

/// Whether an attribute says how the input is stored or what its channels are, which does not hold for another file.
bool describes_storage(const std::string& name) {
  static const std::set<std::string> kNames = {"channels",
                                               "compression",
                                               "dataWindow",
                                               "displayWindow",
                                               "pixelAspectRatio",
                                               "lineOrder",
                                               "tiles",
                                               "chunkCount",
                                               "type",
                                               "version",
                                               "name",
                                               "preview",
                                               "dwaCompressionLevel",
                                               "zipCompressionLevel",
                                               "multiView",
                                               "deepImageState",
                                               "maxSamplesPerPixel",
                                               "idManifest",
                                               "BlenderMultiChannel"};
  return kNames.contains(name) || name.rfind("cryptomatte/", 0) == 0;
}

bool is_own_attribute(std::string_view name) { return name.starts_with("alcove/"); }

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

Imf::Slice slice_of(const Window& rows, SampleType type, std::span<const float> pixels,
                    std::deque<std::vector<std::uint16_t>>& halves) {
  const bool is_half = type == SampleType::half_float;
  const std::size_t bytes = is_half ? sizeof(std::uint16_t) : sizeof(float);
  if (is_half) narrow(pixels.data(), pixels.size(), halves.emplace_back(pixels.size()).data());
  const void* values = is_half ? static_cast<const void*>(halves.back().data()) : pixels.data();
  return Imf::Slice::Make(pixel_type_of(type), values, box_of(rows), bytes, bytes * std::size_t(rows.width));
}

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
  ExrOutput output;  // without pixels
  FileStream stream;
  std::unique_ptr<ZipWriter> zip;
  std::unique_ptr<Imf::OutputFile> file;  // where it is not ZIP
  int rows = 0;                           // that are written

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

void write_exr(const std::string& path, const ExrOutput& output) {
  ExrWriter writer(path, output);
  std::vector<std::span<const float>> planes;
  for (const auto& plane : output.planes) planes.push_back(plane.pixels);
  writer.write(planes);
  writer.finish();
}

}  // namespace alcove
