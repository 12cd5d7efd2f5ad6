// OpenEXR's C++ API, wrapped: the only file that includes it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr.h"

#include <ImathBox.h>
#include <ImfArray.h>
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
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTestFile.h>
#include <ImfThreading.h>
#include <ImfVecAttribute.h>
#include <openexr.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <set>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/exr_header.h"
#include "core/formats/image_io.h"

namespace alcove {

class ExrAttributes {
 public:
  Imf::Header header;
};

namespace {

constexpr std::size_t kLongestText = std::size_t(1) << 16;  // of an attribute that is looked at
constexpr std::size_t kMostPixels = std::size_t(1) << 28;   // in host memory: one gigabyte per channel

Window window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1};
}

Imath::Box2i box_of(const Window& window) {
  return {{window.x, window.y}, {window.x + window.width - 1, window.y + window.height - 1}};
}

SampleType type_of(Imf::PixelType type) {
  return type == Imf::HALF    ? SampleType::half_float
         : type == Imf::FLOAT ? SampleType::single_float
                              : SampleType::integer;
}

/// Gives OpenEXR's description of an error on one line.
std::string one_line(const std::exception& error) {
  std::string text = error.what();
  std::ranges::replace(text, '\n', ' ');
  return text;
}

ExrPart describe(const Imf::Header& header) {
  ExrPart part{header.hasName() ? header.name() : std::string(),
               header.hasView() ? header.view() : std::string(),
               {},
               window_of(header.dataWindow()),
               {}};
  part.dwa = header.compression() == Imf::DWAA_COMPRESSION || header.compression() == Imf::DWAB_COMPRESSION;
  if (Imf::hasMultiView(header)) part.multi_view = Imf::multiView(header);
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const auto& c = channel.channel();
    part.channels.push_back({channel.name(), type_of(c.type), c.xSampling != 1 || c.ySampling != 1});
  }
  return part;
}

/// An output stream into a file in the making. OpenEXR swallows what fails while it closes a file; failed() keeps it.
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
  const std::optional<Error>& failure() const { return failure_; }
  void commit() { file_.commit(); }

 private:
  NewFile file_;
  std::uint64_t position_ = 0;
  std::optional<Error> failure_;
};

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
                                               "BlenderMultiChannel"};
  return kNames.contains(name) || name.rfind("cryptomatte/", 0) == 0;
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

Imf::Compression compression_of(const std::string& name) {
  if (name == "none") return Imf::NO_COMPRESSION;
  if (name == "rle") return Imf::RLE_COMPRESSION;
  if (name == "zips") return Imf::ZIPS_COMPRESSION;
  if (name == "piz") return Imf::PIZ_COMPRESSION;
  return Imf::ZIP_COMPRESSION;
}

Imf::Header header_of(const ExrOutput& output) {
  Imf::Header header(box_of(output.display), box_of(output.data), float(output.pixel_aspect));
  header.compression() = compression_of(output.compression);
  if (output.attributes)
    for (auto attribute = output.attributes->header.begin(); attribute != output.attributes->header.end(); ++attribute)
      if (!describes_storage(attribute.name())) header.insert(attribute.name(), attribute.attribute());
  for (const auto& [name, value] : output.own_attributes) {
    header.erase(name);  // the input's may be of another type
    header.insert(name, Imf::StringAttribute(value));
  }
  for (const auto& plane : output.planes)
    header.channels().insert(plane.channel,
                             Imf::Channel(plane.type == SampleType::half_float ? Imf::HALF : Imf::FLOAT));
  return header;
}

/// Rounds to nearest. Values beyond half's range become its largest value, not infinity.
std::vector<half> to_half(std::span<const float> values) {
  std::vector<half> halves(values.size());
  std::ranges::transform(values, halves.begin(),
                         [](float x) { return half(std::abs(x) > HALF_MAX ? std::copysign(HALF_MAX, x) : x); });
  return halves;
}

}  // namespace

struct ExrFile::Impl {
  std::string path, option;
  std::unique_ptr<Imf::MultiPartInputFile> file;
  std::vector<ExrPart> parts;
  Window display;
  double pixel_aspect = 1;
  std::unique_ptr<PictureReader> picture;  // where there is no file
  Image image;                             // where there is no picture either

  /// One part with these channels.
  Impl(const std::string& path_, const char* option_, const Window& data, const Window& display_,
       const std::vector<std::string>& names)
      : path(path_), option(option_), parts{{"", "", {}, data, {}, false}}, display(display_) {
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
    if (!Imf::isOpenExrFile(path.c_str())) fail(ErrorKind::input, "{}: not an OpenEXR file ({})", path, option);
    require_sane_header(path, option);
    impl_->file = std::make_unique<Imf::MultiPartInputFile>(path.c_str());
    for (int part = 0; part < impl_->file->parts(); part++) {
      const auto& header = impl_->file->header(part);
      if (header.hasType() && Imf::isDeepData(header.type()))
        fail(ErrorKind::input,
             "{}: part {} holds deep data, which has no single depth per pixel; flatten it first ({})", path, part,
             option);
      impl_->parts.push_back(describe(header));
      if (impl_->parts.back().channels.empty())
        fail(ErrorKind::input, "{}: part {} has no channels ({})", path, part, option);
    }
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

ExrFile::ExrFile(const std::string& path, const char* option, Image image)
    : impl_(std::make_unique<Impl>(path, option, image.data, image.display, image.names)) {
  impl_->image = std::move(image);
}

void require_host_room(const std::string& path, const Window& data) {
  if (data.pixels() > kMostPixels)
    fail(ErrorKind::input, "{}: {} are more pixels than are read as a whole; use a smaller frame", path,
         to_string(data));
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

void ExrFile::read(std::span<const ExrRead> reads) {
  // All parts that are read together cover the same pixels.
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
  if (!impl_->file) {
    const std::size_t width = std::size_t(impl_->image.data.width);
    for (const auto& read : reads)
      std::ranges::copy(impl_->image.plane(read.channel).subspan(std::size_t(first) * width, std::size_t(rows) * width),
                        read.to);
    return;
  }
  std::set<int> parts;
  for (const auto& read : reads) parts.insert(read.part);
  for (const int part : parts) {
    Window data = impl_->parts[std::size_t(part)].data;
    data.y += first;
    data.height = rows;
    const std::size_t row_bytes = sizeof(float) * std::size_t(data.width);
    Imf::FrameBuffer frame_buffer;
    for (const auto& read : reads)
      if (read.part == part)
        frame_buffer.insert(read.channel,
                            Imf::Slice::Make(Imf::FLOAT, read.to, box_of(data), sizeof(float), row_bytes));
    try {
      Imf::InputPart input(*impl_->file, part);
      input.setFrameBuffer(frame_buffer);
      input.readPixels(data.y, data.y + data.height - 1);
    } catch (const std::exception& error) {
      fail(ErrorKind::input, "{}: the pixels of part {} cannot be read ({}), the file is damaged or incomplete: {}",
           impl_->path, part, impl_->option, one_line(error));
    }
  }
}

struct ExrWriter::Impl {
  std::string path;
  Window data;
  std::vector<ExrPlane> planes;
  FileStream stream;
  std::unique_ptr<Imf::OutputFile> file;
  int rows = 0;  // that are written

  Impl(const std::string& path_, const ExrOutput& output)
      : path(path_), data(output.data), planes(output.planes), stream(path_) {}

  /// Runs a step of writing. Where the stream failed, its error is the reason that OpenEXR does not tell.
  template <class Function>
  void run(Function&& function) {
    try {
      function();
    } catch (const std::exception& error) {
      if (!stream.failure()) fail(ErrorKind::output, "{}: could not be encoded: {}", path, one_line(error));
    }
    if (stream.failure()) throw *stream.failure();
  }
};

ExrWriter::ExrWriter(const std::string& path, const ExrOutput& output) : impl_(std::make_unique<Impl>(path, output)) {
  impl_->run([&] { impl_->file = std::make_unique<Imf::OutputFile>(impl_->stream, header_of(output)); });
}
ExrWriter::~ExrWriter() = default;
ExrWriter::ExrWriter(ExrWriter&&) noexcept = default;

void ExrWriter::write(std::span<const std::span<const float>> planes) {
  Window band = impl_->data;
  band.y += impl_->rows;
  band.height = int(planes[0].size() / std::size_t(band.width));
  std::deque<std::vector<half>> halves;
  Imf::FrameBuffer frame_buffer;
  for (std::size_t i = 0; i < planes.size(); i++) {
    const bool is_half = impl_->planes[i].type == SampleType::half_float;
    const std::size_t bytes = is_half ? sizeof(half) : sizeof(float);
    const void* pixels =
        is_half ? static_cast<const void*>(halves.emplace_back(to_half(planes[i])).data()) : planes[i].data();
    frame_buffer.insert(impl_->planes[i].channel,
                        Imf::Slice::Make(is_half ? Imf::HALF : Imf::FLOAT, pixels, box_of(band), bytes,
                                         bytes * std::size_t(band.width)));
  }
  impl_->run([&] {
    impl_->file->setFrameBuffer(frame_buffer);
    impl_->file->writePixels(band.height);
  });
  impl_->rows += band.height;
}

void ExrWriter::finish() {
  impl_->run([&] { impl_->file.reset(); });
  impl_->stream.commit();
}

void write_exr(const std::string& path, const ExrOutput& output) {
  ExrWriter writer(path, output);
  std::vector<std::span<const float>> planes;
  for (const auto& plane : output.planes) planes.push_back(plane.pixels);
  writer.write(planes);
  writer.finish();
}

Image read_exr_image(const std::string& path, const std::vector<std::string>& channels) {
  ExrFile file(path, "INPUT");
  const auto has_all = [&](const ExrPart& part) {
    return std::ranges::all_of(channels, [&](const auto& name) {
      return std::ranges::find(part.channels, name, &ExrChannel::name) != part.channels.end();
    });
  };
  const auto part = std::ranges::find_if(file.parts(), has_all);
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

std::optional<std::string> attribute_of_whole_exr(const std::string& path, const std::string& name) {
  exr_context_initializer_t quiet = EXR_DEFAULT_CONTEXT_INITIALIZER;
  quiet.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
  exr_context_t raw = nullptr;
  if (exr_start_read(&raw, path.c_str(), &quiet) != EXR_ERR_SUCCESS) return std::nullopt;
  const std::unique_ptr<std::remove_pointer_t<exr_context_t>, void (*)(exr_context_t)> file(
      raw, [](exr_context_t context) { exr_finish(&context); });
  exr_attr_box2i_t data;
  int32_t rows = 0, length = 0;
  const char* text = nullptr;
  if (exr_get_data_window(raw, 0, &data) != EXR_ERR_SUCCESS ||
      exr_get_scanlines_per_chunk(raw, 0, &rows) != EXR_ERR_SUCCESS || rows <= 0 ||
      exr_attr_get_string(raw, 0, name.c_str(), &length, &text) != EXR_ERR_SUCCESS)
    return std::nullopt;
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  for (std::int64_t y = data.min.y; y <= data.max.y; y += rows) {
    exr_chunk_info_t chunk;
    if (error || exr_read_scanline_chunk_info(raw, 0, int(y), &chunk) != EXR_ERR_SUCCESS ||
        chunk.data_offset + chunk.packed_size > size)
      return std::nullopt;
  }
  return std::string(text, std::size_t(length));
}

float from_half(std::uint16_t bits) {
  half value;
  value.setBits(bits);
  return value;
}

void set_exr_threads(int threads) { Imf::setGlobalThreadCount(threads); }

}  // namespace alcove
