// The composite is the beauty's file with another beauty: every other channel, part and attribute as it was.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "tests/support/openexr.h"

namespace alcove::composite_layers_test {
namespace {

using namespace test;
using Plane = std::vector<float>;

/// What a part holds: its attributes as they are stored, and of each channel the samples, bit for bit.
struct PartContent {
  std::string type;
  Imf::Compression compression;
  Window data;
  std::map<std::string, std::string> attributes;
  std::map<std::string, std::pair<Imf::PixelType, std::string>> channels;
};

std::string stored(const Imf::Attribute& attribute) {
  struct Text : Imf::OStream {
    Text() : Imf::OStream("text") {}
    void write(const char c[], int n) override { bytes.append(c, std::size_t(n)); }
    std::uint64_t tellp() override { return bytes.size(); }
    void seekp(std::uint64_t) override {}
    std::string bytes;
  } text;
  attribute.writeValueTo(text, 2);
  return std::string(attribute.typeName()) + " " + text.bytes;
}

std::vector<PartContent> content_of(const std::string& path) {
  std::vector<PartContent> parts;
  Imf::MultiPartInputFile file(path.c_str());
  for (int p = 0; p < file.parts(); p++) {
    const Imf::Header& header = file.header(p);
    const Imath::Box2i box = header.dataWindow();
    PartContent part{header.hasType() ? header.type() : "",
                     header.compression(),
                     {box.min.x, box.min.y, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1},
                     {},
                     {}};
    for (auto at = header.begin(); at != header.end(); ++at) part.attributes[at.name()] = stored(at.attribute());
    const std::size_t width = std::size_t(part.data.width), pixels = part.data.pixels();
    if (part.type == Imf::DEEPSCANLINE) {
      Imf::DeepScanLineInputPart deep(file, p);
      for (int y = box.min.y; y <= box.max.y; y++) {
        std::string raw(1 << 16, '\0');
        std::uint64_t size = raw.size();
        deep.rawPixelData(y, raw.data(), size);
        part.channels["chunks"].second += raw.substr(0, size);
      }
    } else if (part.type == Imf::TILEDIMAGE) {
      Imf::TiledInputPart tiles(file, p);
      for (int level = 0; level < tiles.numLevels(); level++)
        for (int y = 0; y < tiles.numYTiles(level); y++)
          for (int x = 0; x < tiles.numXTiles(level); x++) {
            const char* raw = nullptr;
            int size = 0, dx = x, dy = y, lx = level, ly = level;
            tiles.rawTileData(dx, dy, lx, ly, raw, size);
            part.channels["chunks"].second += std::string(raw, std::size_t(size));
          }
    } else {
      Imf::FrameBuffer buffer;
      for (auto at = header.channels().begin(); at != header.channels().end(); ++at) {
        const Imf::Channel& channel = at.channel();
        const std::size_t bytes = channel.type == Imf::HALF ? 2 : 4;
        auto& samples = part.channels[at.name()];
        samples = {channel.type, std::string(bytes * pixels, '\0')};
        buffer.insert(at.name(), Imf::Slice::Make(channel.type, samples.second.data(), box, bytes,
                                                  bytes * width / std::size_t(channel.xSampling), channel.xSampling,
                                                  channel.ySampling));
      }
      Imf::InputPart in(file, p);
      in.setFrameBuffer(buffer);
      in.readPixels(box.min.y, box.max.y);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

/// A number for every place of every channel; bits of all kinds for floats, NaN too.
std::uint32_t bits_of(const std::string& channel, std::size_t i) {
  return std::uint32_t(std::hash<std::string>()(channel) * 31 + i * 2654435761U);
}

/// The planes of a part in memory, and the slices that give them to OpenEXR.
class Planes {
 public:
  explicit Planes(const Imf::Header& header) {
    const Imath::Box2i box = header.dataWindow();
    const std::size_t width = std::size_t(box.max.x - box.min.x + 1), height = std::size_t(box.max.y - box.min.y + 1);
    for (auto at = header.channels().begin(); at != header.channels().end(); ++at) {
      const Imf::Channel& channel = at.channel();
      const std::string name = at.name();
      const bool is_color = std::string("RGBA").find(name.back()) != std::string::npos;
      auto& bytes = planes_.emplace_back();
      const std::size_t size = channel.type == Imf::HALF ? 2 : 4;
      bytes.resize(size * width * height);
      for (std::size_t i = 0; i < width * height; i++) {
        const std::uint32_t bits = bits_of(name, i);
        const float color = name.back() == 'A' ? 1 : 0.25f + float(bits % 997) / 997;
        if (channel.type == Imf::HALF) {
          const half value(is_color ? color : float(int(bits % 4001) - 2000));
          std::memcpy(&bytes[2 * i], &value, 2);
        } else {
          std::memcpy(&bytes[4 * i], is_color ? static_cast<const void*>(&color) : &bits, 4);
        }
      }
      buffer.insert(
          name, Imf::Slice::Make(channel.type, bytes.data(), box, size, size * width / std::size_t(channel.xSampling),
                                 channel.xSampling, channel.ySampling));
    }
  }
  Imf::FrameBuffer buffer;

 private:
  std::vector<std::string> planes_;
};

class CompositeLayers : public CommandLine {
 protected:
  Imf::Header header(const std::string& name, const std::string& type, const std::map<std::string, Imf::PixelType>& of,
                     Imf::Compression compression = Imf::ZIP_COMPRESSION) const {
    Imf::Header result(box_of(kWallWindow), box_of(kWallWindow));
    result.compression() = compression;
    if (!name.empty()) result.setName(name);
    if (!type.empty()) result.setType(type);
    if (type == Imf::TILEDIMAGE || type == Imf::DEEPTILE)
      result.setTileDescription(Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS));
    for (const auto& [channel, pixel_type] : of) result.channels().insert(channel, Imf::Channel(pixel_type));
    result.insert("studio/" + (name.empty() ? "only" : name), Imf::StringAttribute("kept"));
    return result;
  }

  /// Writes flat parts, and deep ones with a sample in every second pixel.
  void write(const std::vector<Imf::Header>& headers) const {
    if (!headers.front().hasType()) {
      const Planes planes(headers.front());
      Imf::OutputFile rows(beauty.c_str(), headers.front());
      rows.setFrameBuffer(planes.buffer);
      rows.writePixels(kWallWindow.height);
      return;
    }
    Imf::MultiPartOutputFile file(beauty.c_str(), headers.data(), int(headers.size()));
    for (int p = 0; p < int(headers.size()); p++) {
      const std::string type = headers[std::size_t(p)].hasType() ? headers[std::size_t(p)].type() : "";
      if (type == Imf::DEEPSCANLINE) {
        write_deep(file, p);
        continue;
      }
      const Planes planes(headers[std::size_t(p)]);
      if (type == Imf::TILEDIMAGE) {
        Imf::TiledOutputPart tiles(file, p);
        tiles.setFrameBuffer(planes.buffer);
        for (int level = 0; level < tiles.numLevels(); level++)
          tiles.writeTiles(0, tiles.numXTiles(level) - 1, 0, tiles.numYTiles(level) - 1, level);
      } else {
        Imf::OutputPart rows(file, p);
        rows.setFrameBuffer(planes.buffer);
        rows.writePixels(kWallWindow.height);
      }
    }
  }

  static void write_deep(Imf::MultiPartOutputFile& file, int part) {
    const std::size_t width = std::size_t(kWallWindow.width), pixels = kWallWindow.pixels();
    std::vector<unsigned> counts(pixels);
    std::vector<float> values(pixels);
    std::vector<float*> at(pixels);
    for (std::size_t i = 0; i < pixels; i++) {
      counts[i] = i % 2;
      values[i] = float(i) / 7;
      at[i] = &values[i];
    }
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 4 * width));
    buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(at.data()), sizeof(float*),
                                      sizeof(float*) * width, sizeof(float)));
    Imf::DeepScanLineOutputPart out(file, part);
    out.setFrameBuffer(buffer);
    out.writePixels(kWallWindow.height);
  }

  std::vector<PartContent> composited(const std::string& more = {}) const {
    return done(joined(options, typed("--type float " + more))).code ? std::vector<PartContent>()
                                                                     : content_of(composite);
  }

  /// Everything must be as before, but the beauty, in `part`, which must be another one.
  static void expect_kept(const std::vector<PartContent>& before, const std::vector<PartContent>& after, int part,
                          const std::string& colors) {
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t p = 0; p < before.size(); p++) {
      EXPECT_EQ(before[p].data, after[p].data) << p;
      for (const auto& [name, value] : before[p].attributes)
        if (int(p) != part ||
            !std::set<std::string>{"channels", "chunkCount", "lineOrder", "tiles", "type", "compression"}.contains(
                name))
          EXPECT_EQ(after[p].attributes.contains(name) ? after[p].attributes.at(name) : "none", value) << p << name;
      for (const auto& [name, samples] : before[p].channels) {
        ASSERT_TRUE(after[p].channels.contains(name)) << p << name;
        const bool is_color = int(p) == part && name.size() > 1 && name.starts_with(colors) && !name.ends_with("A");
        EXPECT_EQ(after[p].channels.at(name).first, samples.first) << p << name;
        EXPECT_EQ(after[p].channels.at(name).second == samples.second, !is_color) << p << name;
      }
    }
  }

  std::map<std::string, Imf::PixelType> beauty_channels() const {
    std::map<std::string, Imf::PixelType> channels{{"id", Imf::UINT}, {"P.Y", Imf::FLOAT}, {"mask.h", Imf::HALF}};
    for (const char* c : {"R", "G", "B", "A"}) channels[std::string("Combined.") + c] = Imf::HALF;
    return channels;
  }

  const std::string beauty = folder / "beauty.exr", composite = folder / "composite.exr";
  const Options options{"--beauty", beauty, "--composite", composite};
};

TEST_F(CompositeLayers, of_one_part_keep_every_bit_beside_the_beauty) {
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
                                 Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION}) {
    write({header("", "", beauty_channels(), compression)});
    const auto before = content_of(beauty), after = composited();
    expect_kept(before, after, 0, "Combined.");
    EXPECT_EQ(after[0].compression, compression);
    EXPECT_TRUE(after[0].attributes.contains("alcove/composite"));
  }
}

TEST_F(CompositeLayers, hold_what_the_composite_of_rgba_alone_holds) {
  write({header("", "", beauty_channels())});
  const auto all = composited(), alone = composited("--set composite-layers=rgba");
  ASSERT_EQ(alone.size(), 1);
  EXPECT_EQ(alone[0].channels.size(), 4);
  for (const char* c : {"R", "G", "B", "A"})
    EXPECT_EQ(all[0].channels.at(std::string("Combined.") + c), alone[0].channels.at(c)) << c;
}

TEST_F(CompositeLayers, of_several_parts_keep_tiles_levels_deep_samples_and_lossy_bits) {
  write({header("data", Imf::SCANLINEIMAGE, {{"Q.X", Imf::FLOAT}, {"Q.Y", Imf::FLOAT}}, Imf::DWAA_COMPRESSION),
         header("beauty", Imf::SCANLINEIMAGE, beauty_channels(), Imf::PIZ_COMPRESSION),
         header("tiles", Imf::TILEDIMAGE, {{"T.h", Imf::HALF}}),
         header("deep", Imf::DEEPSCANLINE, {{"Z", Imf::FLOAT}}, Imf::ZIPS_COMPRESSION)});
  const auto before = content_of(beauty), after = composited();
  expect_kept(before, after, 1, "Combined.");
  for (std::size_t p = 0; p < before.size(); p++) {
    EXPECT_EQ(after[p].compression, before[p].compression) << p;
    EXPECT_EQ(after[p].type, before[p].type) << p;
  }
  EXPECT_TRUE(after[0].attributes.contains("alcove/options")) << "the first part tells --resume";
}

TEST_F(CompositeLayers, of_tiles_or_lossy_parts_become_lossless_scan_lines) {
  write({header("", Imf::TILEDIMAGE, beauty_channels())});
  const Image tiled = read_exr_image(beauty, {"P.Y", "mask.h"});
  const auto rows = composited();
  EXPECT_EQ(rows[0].type, Imf::SCANLINEIMAGE);
  EXPECT_EQ(std::memcmp(read_exr_image(composite, {"P.Y", "mask.h"}).pixels.data(), tiled.pixels.data(),
                        tiled.pixels.size() * sizeof(float)),
            0);
  write({header("", "", beauty_channels(), Imf::DWAA_COMPRESSION)});
  const auto before = content_of(beauty), after = composited();
  expect_kept(before, after, 0, "Combined.");
  EXPECT_EQ(after[0].compression, Imf::ZIP_COMPRESSION);
  EXPECT_EQ(composited("--set composite-compression=dwab")[0].compression, Imf::DWAB_COMPRESSION);
}

TEST_F(CompositeLayers, may_take_the_ao_too) {
  write({header("", "", beauty_channels())});
  const auto before = content_of(beauty), after = composited("--set append-ao=AO");
  expect_kept(before, after, 0, "Combined.");
  EXPECT_EQ(after[0].channels.size(), before[0].channels.size() + 1);
  EXPECT_EQ(read_exr_image(composite, {"AO.Y"}).pixels, read_exr_image(ao).pixels);
  EXPECT_TRUE(composited("--set append-ao=Light.occlusion")[0].channels.contains("Light.occlusion"));
  EXPECT_TRUE(composited("--set append-ao=AO --set composite-layers=rgba")[0].channels.contains("AO.Y"));
  composited("--set ao-name=shadow.Y");
  EXPECT_EQ(read_exr_image(ao).names, Options{"shadow.Y"});
  composited("--set ao-name=shadow --set ao-channels=rgb");
  EXPECT_THAT(read_exr_image(ao).names, UnorderedElementsAre("shadow.R", "shadow.G", "shadow.B"));
}

TEST_F(CompositeLayers, of_a_region_are_cut_to_it_where_they_are_of_its_window) {
  write({header("beauty", Imf::SCANLINEIMAGE, beauty_channels()),
         header("more", Imf::SCANLINEIMAGE, {{"Q.X", Imf::FLOAT}}, Imf::PIZ_COMPRESSION),
         header("deep", Imf::DEEPSCANLINE, {{"Z", Imf::FLOAT}}, Imf::ZIPS_COMPRESSION)});
  const Image before = read_exr_image(beauty, {"Q.X"});
  const auto deep = content_of(beauty)[2];
  const Window region{10, 12, 20, 16};
  const auto after = composited("--roi 10,12,20,16");
  EXPECT_EQ(after[0].data, region);
  EXPECT_EQ(after[1].data, region);
  EXPECT_EQ(after[2].data, kWallWindow);
  EXPECT_EQ(after[2].channels, deep.channels);
  const Plane cut = read_exr_image(composite, {"Q.X"}).pixels, expected = cropped(before.pixels, kWallWindow, region);
  ASSERT_EQ(cut.size(), expected.size());
  EXPECT_EQ(std::memcmp(cut.data(), expected.data(), sizeof(float) * cut.size()), 0) << "which may be NaN";
}

TEST_F(CompositeLayers, of_frames_that_are_done_are_left_by_resume_and_others_are_not) {
  write({header("beauty", Imf::SCANLINEIMAGE, beauty_channels()),
         header("more", Imf::SCANLINEIMAGE, {{"Q.X", Imf::FLOAT}}, Imf::PIZ_COMPRESSION),
         header("tiles", Imf::TILEDIMAGE, {{"T.h", Imf::HALF}})});
  const auto is_made = [&](const std::string& more) {
    return done(joined(options, typed("--resume " + more))).err.find("whole, kept") == std::string::npos;
  };
  EXPECT_TRUE(is_made(""));
  EXPECT_FALSE(is_made("")) << "it is done";
  EXPECT_TRUE(is_made("--set append-ao=AO"));
  EXPECT_TRUE(is_made("--set gain=2"));
  EXPECT_TRUE(is_made("")) << "what is there is another one";
  const auto whole = fs::file_size(composite);
  for (const double part : {0.999, 0.9, 0.5}) {
    fs::resize_file(composite, std::uintmax_t(part * double(whole)));
    EXPECT_TRUE(is_made("")) << part << " of it is left";
  }
}

// Notes that come late are put into the header of a file that is written already.
TEST_F(CompositeLayers, take_notes_that_come_late) {
  FrameFile file = wall_frame();
  file.planes["ViewLayer.Depth.Z"][70] = std::numeric_limits<float>::quiet_NaN();
  file.write(frame);
  write({header("beauty", Imf::SCANLINEIMAGE, beauty_channels()),
         header("tiles", Imf::TILEDIMAGE, {{"T.h", Imf::HALF}}),
         header("deep", Imf::DEEPSCANLINE, {{"Z", Imf::FLOAT}}, Imf::ZIPS_COMPRESSION)});
  const auto before = content_of(beauty), after = composited();
  expect_kept(before, after, 0, "Combined.");
  EXPECT_TRUE(after[0].attributes.contains("alcove/notes"));
}

TEST_F(CompositeLayers, mistakes_are_named_in_one_line) {
  write({header("", "", beauty_channels())});
  std::vector<std::tuple<int, std::string, Options>> rows{
      {3, "append-ao=Combined.R", {beauty, "Combined.R", "--set append-ao"}},
      {2, "append-ao=AO composite-compression=dwaa", {"--set append-ao=AO", "dwaa", "AO.ao"}},
      {2, "composite-layers=some", {"--set composite-layers", "all"}},
      {3, "ambient=Combinet", {beauty, "Combinet", "--set ambient"}}};
  for (const std::string text :
       {"Combined*2", "Combined*-1", "Combined**1", "*1", "Combined*a*b", "Combined*1*1", "Combined,"})
    rows.push_back({2, "ambient=" + text, {"--set ambient", "LIGHT*NUMBER"}});
  for (const std::string text : {"1,1", "1,1,2", "a,b,c", "0.5"})
    rows.push_back({2, "tint=" + text, {"--set tint", text}});
  for (const auto& [code, settings, texts] : rows) {
    Options more = options;
    for (const auto& setting : typed(settings)) more = joined(more, {"--set", setting});
    expect_refused(code, more, texts);
  }
  // The file is cut within its pixels.
  fs::resize_file(beauty, fs::file_size(beauty) * 3 / 4);
  expect_refused(3, options, {beauty});
  // A beauty of one colour is none.
  FrameFile file = wall_frame();
  add_beauty(file);
  for (const float color : {0.0F, 0.5F}) {
    for (const char* c : {"R", "G", "B"})
      file.planes[std::string("ViewLayer.Combined.") + c].assign(kWallWindow.pixels(), color);
    file.write(frame);
    const Finished finished = run({"--composite", composite});
    EXPECT_EQ(finished.code, 3) << finished;
    EXPECT_THAT(finished.err, AllOf(HasSubstr(frame), HasSubstr("Combined"), HasSubstr("--beauty")));
    EXPECT_EQ(finished.err.find("black") != std::string::npos, color == 0) << finished;
  }
  EXPECT_FALSE(fs::exists(composite));
}

/// A beauty of several lights, and the composite by plain arithmetic.
class Lights : public CompositeLayers {
 protected:
  Lights() : file(wall_frame()) {
    add_beauty(file);
    std::size_t at = 0;
    for (const char* layer : {"GlossInd", "GlossCol", "GI", "key_light"})
      for (const char* c : {"R", "G", "B"}) {
        Plane& plane = file.planes[std::string("ViewLayer.") + layer + "." + c];
        for (std::size_t i = 0; i < kWallWindow.pixels(); i++) plane.push_back(float((i * 37 + 101 * at) % 503) / 503);
        at++;
      }
  }

  using Ambient = std::function<double(std::size_t, const char*)>;
  /// The largest difference between the composite and color - D o (1 - tint).
  double error(const std::string& more, const Ambient& ambient, double gain = 1, double mix = 1,
               const std::array<double, 3>& tint = {}) const {
    file.write(frame);
    if (done(typed("--set composite-layers=rgba --type float --composite " + composite + " " + more)).code) return 1e9;
    const Image result = read_exr_image(composite), visible = read_exr_image(ao);
    double largest = 0, taken = 0;
    for (int c = 0; c < 3; c++) {
      const char* component = c == 0 ? "R" : c == 1 ? "G" : "B";
      const auto composite_plane = result.plane(component);
      for (std::size_t i = 0; i < kWallWindow.pixels(); i++) {
        const double alpha = at("Combined", "A", i), o = mix * alpha * std::min(gain * (1.0 - visible.pixels[i]), 1.0);
        const double less = ambient(i, component) * o * (1 - tint[std::size_t(c)]);
        largest = std::max(largest, std::abs(composite_plane[i] - (at("Combined", component, i) - less)));
        taken = std::max(taken, std::abs(less));
      }
    }
    EXPECT_GT(taken, 0.05) << "or else there is nothing to see";
    return largest;
  }

  double at(const std::string& layer, const std::string& component, std::size_t i) const {
    return file.planes.at("ViewLayer." + layer + "." + component)[i];
  }

  FrameFile file;
  const Ambient diffuse = [this](std::size_t i, const char* c) { return at("DiffInd", c, i) * at("DiffCol", c, i); };
};

TEST_F(Lights, are_dimmed_by_their_weights_and_take_the_colours_that_belong_to_them) {
  const Ambient gloss = [&](std::size_t i, const char* c) { return at("GlossInd", c, i) * at("GlossCol", c, i); };
  const std::pair<const char*, Ambient> rows[] = {
      {"", diffuse},  // as ever
      {"--set ambient=DiffInd", diffuse},
      {"--set ambient=DiffInd,GlossInd*0.25",
       [&](std::size_t i, const char* c) { return diffuse(i, c) + 0.25 * gloss(i, c); }},
      {"--set ambient=GI*DiffCol*0.5,key_light",
       [&](std::size_t i, const char* c) {
         return 0.5 * at("GI", c, i) * at("DiffCol", c, i) + at("key_light", c, i);
       }},
      {"--set ambient=ViewLayer.GI", [&](std::size_t i, const char* c) { return at("GI", c, i); }},
      {"--set ambient=Combined", [&](std::size_t i, const char* c) { return at("Combined", c, i); }}};
  for (const auto& [more, ambient] : rows) EXPECT_LT(error(more, ambient), 1e-5) << more;
}

TEST_F(Lights, are_dimmed_by_gain_tint_and_mix) {
  EXPECT_LT(error("--set gain=2.5", diffuse, 2.5), 1e-5);
  EXPECT_LT(error("--set mix=0.4", diffuse, 1, 0.4), 1e-5);
  EXPECT_LT(error("--set tint=0.2,0.1,0", diffuse, 1, 1, {0.2, 0.1, 0}), 1e-5);
  EXPECT_LT(error("--set tint=0.2,0.1,0 --set gain=3 --set mix=0.7", diffuse, 3, 0.7, {0.2, 0.1, 0}), 1e-5);
  EXPECT_GT(error("--set gain=2.5", diffuse, 1), 0.01) << "or else nothing is told apart";
}

}  // namespace
}  // namespace alcove::composite_layers_test
