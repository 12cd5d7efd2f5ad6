// Finding, uploading and writing the planes of a frame; its preview and its debug views.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <mutex>
#include <utility>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/option_words.h"
#include "core/base/ranks.h"
#include "core/base/version.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/geometry/geometry.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/outputs.h"
#include "core/formats/png.h"
#include "core/frame/find/behind.h"
#include "core/frame/pixels/ramps.h"
#include "core/frame/raw_plane.h"
#include "core/frame/settle/settle.h"
#include "core/run/tiles.h"

namespace alcove {
namespace {

// The composite of a beauty whose data window is not the depth's.

/// The most that is put together at once, so that a beauty which is much larger than the depth needs no more memory.
constexpr std::uint64_t kBytesAtOnce = 1 << 20;

const Window& window_of_beauty(const FrameSource& source) {
  return source.part_of(source.channels[RawPlane::beauty][0]).data;
}

/// Of all planes.
std::uint64_t row_bytes(const FrameSource& source) {
  return sizeof(float) * source.channels[RawPlane::beauty].size() * std::uint64_t(window_of_beauty(source).width);
}

/// The window of a frame's composite: the beauty's, or the part of a region that the beauty has.
Window composite_window(const FrameSource& source) {
  const Window& beauty = window_of_beauty(source);
  return source.region ? common_part(picture_of(source.reading, *source.region), beauty) : beauty;
}

/// The composite over a part of its window, so many planes: where `from` has pixels those of `planes`, elsewhere the
/// beauty's, which are read then, and 1 in a plane of AO behind them. Fails as reading a frame does.
std::vector<std::vector<float>> composite_over(FrameSource& source, std::size_t count, const Window& part,
                                               const Window& from, std::span<const std::span<const float>> planes) {
  const auto& beauty = source.channels[RawPlane::beauty];
  const Window& whole = window_of_beauty(source);
  const Window rows{whole.x, part.y, whole.width, part.height};
  const bool is_all_computed = common_part(part, from) == part;
  std::vector<std::vector<float>> composite(count, std::vector<float>(part.pixels(), 1));
  for (std::size_t c = 0; c < count; c++) {
    if (!is_all_computed && c < beauty.size()) {
      std::vector<float> read(rows.pixels());
      const ExrRead channel{beauty[c].part, beauty[c].channel, read.data()};
      source.files[beauty[c].file].read({&channel, 1}, part.y - whole.y, part.height);
      copy_common(read.data(), rows, composite[c].data(), part);
    }
    if (!planes.empty()) copy_common(planes[c].data(), from, composite[c].data(), part);
  }
  return composite;
}

}  // namespace

std::uint64_t composite_bytes(const FrameSource& source) {
  if (source.channels[RawPlane::beauty].empty() || composite_window(source) == written_picture(source)) return 0;
  return 2 * std::max(kBytesAtOnce, kRowsOfOutput * row_bytes(source));  // what is read, and what is made of it
}

// Pictures: numbers on a scale of colours, and frames in the display window.

namespace {

/// The part of the surfaces beyond either end of a percentile scale. So much may lie beyond a window without hiding the
/// room.
constexpr double kEnds = 0.03;

/// The values at the two ends of the scale.
std::pair<float, float> range_of(const DebugView& view, std::span<const float> values) {
  if (view.scale == DebugScale::fixed || view.scale == DebugScale::fixed_logarithmic) return {view.low, view.high};
  std::vector<float> surfaces;
  std::ranges::copy_if(values, std::back_inserter(surfaces), [](float x) { return x < kSkyDepth; });
  if (surfaces.empty()) return {0, 1};
  const auto at = [&](double part) { return value_at_rank(surfaces, std::size_t(part * double(surfaces.size() - 1))); };
  return {at(kEnds), at(1 - kEnds)};
}

/// Where each number stands on the scale, 0 to 1; sky is NaN.
std::vector<float> places_of(const DebugView& view, std::span<const float> values, float low, float high) {
  const bool logarithmic =
      view.scale == DebugScale::fixed_logarithmic || view.scale == DebugScale::percentile_logarithmic;
  const auto on_scale = [&](float x) {
    return logarithmic ? std::log(std::max(std::abs(x), std::numeric_limits<float>::min())) : x;
  };
  const float from = on_scale(low), range = on_scale(high) - from;
  std::vector<float> places(values.size());
  std::ranges::transform(values, places.begin(), [&](float x) {
    if (x >= kSkyDepth) return std::numeric_limits<float>::quiet_NaN();
    return range == 0 ? 0.5f : std::clamp((on_scale(x) - from) / range, 0.0f, 1.0f);
  });
  return places;
}

/// A colour that brightens evenly from violet by green to yellow, display values: a polynomial of the sixth degree
/// through "viridis" of Smith and van der Walt, off by at most .03.
std::array<float, 3> color_at(float place) {
  constexpr std::array<std::array<float, 3>, 7> kPowers{{{0.277727f, 0.005407f, 0.334100f},
                                                         {0.105093f, 1.404614f, 1.384590f},
                                                         {-0.330862f, 0.214848f, 0.095095f},
                                                         {-4.634230f, -5.799101f, -19.332441f},
                                                         {6.228270f, 14.179933f, 56.690553f},
                                                         {4.776385f, -13.745145f, -65.353033f},
                                                         {-5.435456f, 4.645853f, 26.312435f}}};
  std::array<float, 3> color{};
  for (std::size_t c = 0; c < 3; c++)
    for (std::size_t power = kPowers.size(); power-- > 0;) color[c] = color[c] * place + kPowers[power][c];
  return color;
}

/// Writes the picture of one view, a pixel for each number. `values` holds one number per pixel, kSkyDepth for sky.
void write_debug_view(const std::string& path, const DebugView& view, int width, int height,
                      std::span<const float> values, const std::string& made_by) {
  const auto [low, high] = range_of(view, values);
  const bool is_open = view.scale == DebugScale::percentile || view.scale == DebugScale::percentile_logarithmic;
  const auto text = [&](const char* beyond, float x) { return fmt::format("{}{:.4g}", is_open ? beyond : "", x); };
  std::vector<float> pixels;
  pixels.reserve(3 * values.size());
  for (const float place : places_of(view, values, low, high)) {
    const auto color = std::isnan(place) ? kSkyColor : view.is_grey ? std::array{place, place, place} : color_at(place);
    pixels.insert(pixels.end(), color.begin(), color.end());
  }
  write_png(path, width, height, 3, pixels, made_by,
            fmt::format("{}. Darkest: {}, brightest: {}.", view.title, text("<= ", low), text(">= ", high)));
}

/// The display window of `planes` planes over a data window, interleaved; black where there are no pixels.
std::vector<float> displayed(const Window& display, const Window& data, std::span<const float> pixels, int planes) {
  std::vector<float> interleaved(display.pixels() * std::size_t(planes));
  for (int y = std::max(data.y, display.y); y < std::min(data.y + data.height, display.y + display.height); y++)
    for (int x = std::max(data.x, display.x); x < std::min(data.x + data.width, display.x + display.width); x++)
      for (int c = 0; c < planes; c++)
        interleaved[(std::size_t(y - display.y) * std::size_t(display.width) + std::size_t(x - display.x)) *
                        std::size_t(planes) +
                    std::size_t(c)] =
            pixels[std::size_t(c) * data.pixels() + std::size_t(y - data.y) * std::size_t(data.width) +
                   std::size_t(x - data.x)];
  return interleaved;
}

/// A plane over a window as pixels of the picture.
std::vector<float> in_picture(const FrameSource& source, const Window& window, std::span<const float> plane) {
  return middle_pixels(plane, window, source.reading.display, source.reading.supersampling);
}

/// The composite over a window, band by band, since the beauty's rows may be far longer than those of the display.
/// Where nothing is computed it is the beauty.
std::vector<float> shown_composite(FrameSource& source, const Window& window, const gpu::Buffer* computed,
                                   const Window& shown) {
  constexpr int kBand = 64;  // rows; files compress no more together, but for a few
  std::vector<std::vector<float>> planes;
  const auto values = computed ? computed->as<const float>() : std::span<const float>();
  for (std::size_t at = 0; at < values.size(); at += window.pixels())
    planes.push_back(in_picture(source, window, values.subspan(at, window.pixels())));
  const Window from = computed ? picture_of(source.reading, window) : Window{};
  const std::size_t count = source.channels[RawPlane::beauty].size();
  std::vector<float> pixels(count * shown.pixels());
  for (int y = shown.y; y < shown.y + shown.height; y += kBand) {
    const Window band{shown.x, y, shown.width, std::min(kBand, shown.y + shown.height - y)};
    const auto composite =
        composite_over(source, count, band, from, std::vector<std::span<const float>>(planes.begin(), planes.end()));
    for (std::size_t c = 0; c < composite.size(); c++)
      copy_common(composite[c].data(), band, pixels.data() + c * shown.pixels(), shown);
  }
  return pixels;
}

}  // namespace

ShownPicture shown_plane(const FrameSource& source, const Window& window, const gpu::Buffer& planes,
                         std::size_t plane) {
  const Window display = picture_of(source.reading, source.reading.display), data = picture_of(source.reading, window);
  const std::vector<float> pixels =
      in_picture(source, window, planes.as<float>().subspan(plane * window.pixels(), window.pixels()));
  const Window written = written_picture(source);
  return {display.width, display.height, 1, displayed(display, written, cropped(pixels, data, written), 1)};
}

ShownPicture shown_colors(FrameSource& source, const Window& window, const gpu::Buffer* computed,
                          const DisplayTransform* transform) {
  const Window display = picture_of(source.reading, source.reading.display);
  const Window data = common_part(composite_window(source), display);
  ShownPicture shown{display.width, display.height, 3,
                     displayed(display, data, shown_composite(source, window, computed, data), 3)};
  if (transform) transform->apply(shown.pixels);
  return shown;
}

namespace {

/// Both side by side, with a grey line between.
ShownPicture beside(const ShownPicture& left, const ShownPicture& right) {
  constexpr int kLine = 4;  // px
  constexpr float kGrey = 0.5F;
  ShownPicture both{left.width + kLine + right.width, left.height, 3, {}};
  const auto of_row = [](const ShownPicture& shown, std::size_t row) {
    const std::size_t values = 3 * std::size_t(shown.width);
    return std::span(shown.pixels).subspan(row * values, values);
  };
  for (std::size_t row = 0; row < std::size_t(left.height); row++) {
    std::ranges::copy(of_row(left, row), std::back_inserter(both.pixels));
    both.pixels.insert(both.pixels.end(), 3 * kLine, kGrey);
    std::ranges::copy(of_row(right, row), std::back_inserter(both.pixels));
  }
  return both;
}

ShownPicture preview_of(FrameSource& source, const Window& window, const FrameOutputs& outputs,
                        const DisplayTransform* transform, const OutputSettings& settings) {
  const std::string& style = settings.preview_style;
  if (Wanted(settings).previews_shadow) return shown_plane(source, window, *outputs.shadow, settings.read_lights->sun);
  if (!outputs.composite || style == "ao") return shown_plane(source, window, *outputs.ao);
  const ShownPicture composite = shown_colors(source, window, outputs.composite, transform);
  return style == "split" ? beside(shown_colors(source, window, nullptr, transform), composite) : composite;
}

}  // namespace

void write_pictures(FrameSource& source, const Window& computed, const FrameOutputs& outputs,
                    const DisplayTransform* transform, const OutputSettings& settings, const Provenance& provenance,
                    const TakePreview& take_preview) {
  const std::string text = made_by(provenance.options, provenance.inputs);
  for (const auto& plane : outputs.debug)
    write_debug_view(debug_path(settings, *plane.view), *plane.view, plane.size.x, plane.size.y,
                     plane.values->as<float>(), text);
  if (settings.preview.empty()) return;
  const ShownPicture shown = preview_of(source, computed, outputs, transform, settings);
  if (take_preview) return take_preview(shown);
  write_png(settings.preview, shown.width, shown.height, shown.channels, shown.pixels, text);
}

// Planes.

namespace {

namespace fs = std::filesystem;

/// By its word, and its width in px of the picture.
std::string text_of(const PixelFilter& filter) {
  return fmt::format("{} {}", word_of(filter.kind), filter.width.value_or(usual_width(filter.kind)));
}

ExrOutput output_like(const FrameSource& source, const ChannelRef& like, const Window& data,
                      const OutputSettings& settings, const Provenance& provenance) {
  ExrOutput output;
  output.data = data;
  output.display = picture_of(source.reading, source.reading.display);
  output.pixel_aspect = source.reading.pixel_aspect;
  output.attributes = source.files[like.file].attributes(like.part);
  output.own_attributes = {{"alcove/version", kVersion},
                           {"alcove/options", provenance.options},
                           {"alcove/device", provenance.device},
                           {"alcove/inputs", provenance.inputs},
                           {"alcove/input", fs::path(source.depth_path()).filename().string()}};
  if (source.reading.supersampling > 1)
    output.own_attributes["alcove/filter"] = fmt::format("{} x {} px by {}", source.reading.supersampling,
                                                         source.reading.supersampling, text_of(settings.filter));
  std::string hidden = hidden_sources_text(source);
  if (!hidden.empty() && !provenance.others.empty()) hidden += "; ";
  hidden += provenance.others;
  if (!hidden.empty()) output.own_attributes["alcove/hidden"] = hidden;
  if (!provenance.estimates.empty()) output.own_attributes["alcove/accumulated"] = provenance.estimates;
  if (!provenance.notes.empty()) output.own_attributes[kNotesAttribute] = provenance.notes;
  return output;
}

SampleType type_of(const OutputSettings& settings) {
  return settings.type == OutputType::half_float ? SampleType::half_float : SampleType::single_float;
}

/// The AO file, without pixels.
ExrOutput aov_file(const FrameSource& source, const EstimatorSettings& estimator, const OutputSettings& settings,
                   const Provenance& provenance) {
  ExrOutput output =
      output_like(source, source.channels[RawPlane::depth][0], written_picture(source), settings, provenance);
  output.compression = settings.compression;
  if (needs_radius(settings)) output.own_attributes["alcove/radius"] = radius_text(estimator);
  for (const auto& aov : aovs_of(settings)) {
    const SampleType type = aov.is_float ? SampleType::single_float : type_of(settings);
    for (const auto& channel : channels_of(aov, planes_of(aov, estimator))) output.planes.push_back({channel, type});
  }
  if (wants(settings, &FrameOutputs::scales)) output.own_attributes["alcove/radii"] = radius_text(estimator);
  if (wants(settings, &FrameOutputs::normal) || wants(settings, &FrameOutputs::bent_normal) ||
      wants(settings, &FrameOutputs::transfer))
    output.own_attributes["alcove/normal_space"] = in_world(source.reading.camera, settings) ? "world" : "view";
  return output;
}

/// What the composite is made by, in words.
std::string composite_text(const FrameSource& source, const Settings& all) {
  const CompositeLook& look = all.output.look;
  std::string text = "multiply: beauty * ao";
  if (!dims_beauty(source.reading.ambient))
    text = fmt::format("ambient: beauty - D + D * ao, D = {}",
                       all.input.ambient.empty() ? "indirect diffuse" : all.input.ambient);
  if (!all.input.shadow_layers.empty()) text += fmt::format("; shadows: {}", all.input.shadow_layers);
  if (all.output.multi_bounce) text += "; ao with multi-bounce";
  if (look.fog_density > 0) text += fmt::format("; ao seen through fog of density {}", look.fog_density);
  if (look.gain != 1) text += fmt::format("; gain {}", look.gain);
  if (look.tint != std::array<double, 3>{}) text += fmt::format("; tint {}", fmt::join(look.tint, " "));
  if (look.mix != 1) text += fmt::format("; mix {}", look.mix);
  return text;
}

/// The channel that the AO becomes in the composite.
std::string appended_channel(const OutputSettings& settings) {
  return settings.append_ao.find('.') == settings.append_ao.npos ? settings.append_ao + ".Y" : settings.append_ao;
}

/// Whether the composite is a copy of the beauty's file, which is an EXR.
bool keeps_layers(const FrameSource& source, const OutputSettings& settings) {
  return settings.composite_layers == "all" &&
         source.files[source.channels[RawPlane::beauty][0].file].codec_group() > 0;
}

/// The composite, without pixels. Every channel keeps the beauty's precision.
ExrOutput composite_file(const FrameSource& source, const Settings& all, const Provenance& provenance) {
  const OutputSettings& settings = all.output;
  const auto& beauty = source.channels[RawPlane::beauty];
  ExrOutput output = output_like(source, beauty[0], composite_window(source), settings, provenance);
  output.own_attributes["alcove/composite"] = composite_text(source, all);
  output.own_attributes["alcove/radius"] = radius_text(all.estimator);
  output.compression = settings.composite_compression;
  const bool is_copy = keeps_layers(source, settings);
  if (is_copy) output.original = source.files[beauty[0].file].path();
  const char* names[] = {"R", "G", "B", "A"};
  for (std::size_t c = 0; c < beauty.size(); c++)
    output.planes.push_back({is_copy ? beauty[c].channel : names[c],
                             source.is_half(beauty[c]) ? SampleType::half_float : SampleType::single_float,
                             is_copy ? beauty[c].part : 0});
  if (!settings.append_ao.empty())
    output.planes.push_back({appended_channel(settings), type_of(settings), is_copy ? beauty[0].part : 0});
  return output;
}

/// Fails where the AO has no place in the composite.
void require_place_for_ao(const FrameSource& source, const OutputSettings& settings) {
  if (settings.append_ao.empty() || source.channels[RawPlane::beauty].empty()) return;
  const std::string channel = appended_channel(settings);
  const ChannelRef& beauty = source.channels[RawPlane::beauty][0];
  const auto& there = source.part_of(beauty).channels;
  if (keeps_layers(source, settings) && std::ranges::find(there, channel, &ExrChannel::name) != there.end())
    fail(ErrorKind::input, "{}: it has a channel {} already: give --set append-ao another name",
         source.files[beauty.file].path(), channel);
  if (settings.composite_compression.starts_with("dwa") && is_lossy_in_dwa(channel))
    fail(ErrorKind::usage,
         "--set append-ao={}: --set composite-compression={} is lossy for channels that end in R, G, B or Y: name it "
         "{}.ao",
         settings.append_ao, settings.composite_compression, channel.substr(0, channel.rfind('.')));
}

/// Fails with ErrorKind::input where a beauty has one colour all over: Blender writes a layer of zeros where it
/// rendered none.
void require_picture(const FrameSource& source, const Window& window, std::span<const float> beauty) {
  const auto colors = beauty.first(3 * window.pixels());
  if (window != source.reading.data) return;  // a part may be of one colour
  for (std::size_t c = 0; c < 3; c++) {
    const auto plane = colors.subspan(c * window.pixels(), window.pixels());
    if (std::ranges::any_of(plane, [&](float x) { return !(x == plane[0]); })) return;
  }
  const ChannelRef& red = source.channels[RawPlane::beauty][0];
  fail(ErrorKind::input,
       "{}: the beauty {} has one colour in all pixels{}: give the picture with --beauty, or name it with "
       "--set beauty-channels",
       source.files[red.file].path(), red.channel,
       colors[0] == 0 ? ", black, as in a layer that was not rendered" : "");
}

/// Fails with ErrorKind::usage where deep samples beside a flat depth are of no use to the estimator. Only now it is
/// known whether they are beside one.
void require_use_of_deep(const FrameSource& source, const Settings& settings) {
  const bool has_use = searches_slices(settings.estimator) || !settings.output.lights.empty() ||
                       settings.estimator.hidden == 0 || !source.channels.deep;
  if (has_use || source.part_of(source.channels[RawPlane::depth][0]).deep) return;
  fail(ErrorKind::usage,
       "{}: beside a flat depth --deep applies to --estimator gtao or bitmask only: give one of these, or --set "
       "hidden=0, "
       "or leave --deep out",
       source.files[source.channels.deep->elements[0].file].path());
}

/// Fails with ErrorKind::input where a frame lacks what an output is made from.
void require_for_outputs(const FrameSource& source, const OutputSettings& settings) {
  const std::string& file = source.depth_path();
  if (settings.aov_space == NormalSpace::world && !source.reading.camera.view_from_world)
    fail(ErrorKind::input,
         "{}: --set aov-space=world needs a camera with world_to_camera: give a --camera file with it", file);
  if (source.environment && !source.reading.camera.view_from_world)
    fail(ErrorKind::input,
         "{}: --environment lights the world, and needs a camera with world_to_camera: give a --camera file with it",
         file);
  if (settings.multi_bounce && !source.channels[RawPlane::beauty].empty() && dims_beauty(source.reading.ambient))
    fail(
        ErrorKind::input,
        "{}: --set multi-bounce brightens indirect diffuse light in the --composite, and the frame has none (--beauty)",
        file);
  require_place_for_ao(source, settings);
  for (const auto* view : debug_views_of(settings)) {
    if (view->source == DebugSource::raw_depth && source.channels[RawPlane::depth].size() > 1)
      fail(ErrorKind::input,
           "{}: --set debug={} shows a depth, and the frame has positions: name one with --depth-channel, or see "
           "linear-depth",
           file, view->name);
    if (view->source == DebugSource::normals_from_depth && source.channels[RawPlane::normal].empty())
      fail(ErrorKind::input,
           "{}: --set debug={} compares the frame's normals with those from depth, and there are none (--normal, "
           "--normal-channels)",
           file, view->name);
  }
}

/// The light of a picture, which is read once for all frames that follow each other, unless it is written again.
Environment sky_of(const std::string& path) {
  static std::mutex mutex;
  static std::string last_file;
  static Environment last;
  const std::lock_guard lock(mutex);
  std::error_code error;
  const auto written = std::filesystem::last_write_time(path, error).time_since_epoch().count();
  const std::string file = fmt::format("{} {} {}", path, written, std::filesystem::file_size(path, error));
  if (file == last_file) return last;
  last = read_environment(path, "--environment");
  last_file = file;
  return last;
}

/// Reads the light of the settings, if they name any, and notes what nine colours miss of it.
void read_sky(FrameSource& source, const std::string& path) {
  if (path.empty()) return;
  source.environment = sky_of(path);
  if (source.environment->missed > kMostMissed)
    source.notes.push_back({NoteCode::sun_in_sky,
                            fmt::format("nine colours do not hold it: they miss {:.0f} % of its light; a sun needs a "
                                        "light of its own (--environment)",
                                        100 * source.environment->missed),
                            path});
}

/// Whether planes are all that the frame needs.
bool are_of(const ReadPlanes& planes, const FrameSource& source) {
  if (source.reading.cuts_ramps && !source.evidence) return false;  // these are cut, and do not settle a frame
  return std::ranges::all_of(kRawPlanes, [&](const auto& row) {
    return source.channels[row.plane].empty() ||
           planes[row.plane].size() == source.channels[row.plane].size() * source.reading.data.pixels();
  });
}

}  // namespace

FrameSource open_frame(const Settings& settings, int frame) {
  FrameSource source = find_frame(settings.input, !settings.output.composite.empty(), frame,
                                  settings.output.multi_bounce && !settings.input.albedo_value);
  require_use_of_deep(source, settings);
  if (settings.estimator.hidden == 0) {
    source.channels[RawPlane::behind].clear();
    source.reading.behind.clear();
  }
  if (settings.input.roi) source.region = region_of(source, *settings.input.roi);
  if (source.region && !source.channels[RawPlane::beauty].empty() && composite_window(source).pixels() == 0)
    fail(ErrorKind::usage,
         "{}: the beauty has no pixel of --roi, which is {}: give a region within it, or no --composite",
         source.files[source.channels[RawPlane::beauty][0].file].path(), to_string(*source.region));
  read_sky(source, settings.output.environment);
  require_for_outputs(source, settings.output);
  return source;
}

const Window& written_of(const FrameSource& source) { return source.region ? *source.region : source.reading.data; }

Window written_picture(const FrameSource& source) { return picture_of(source.reading, written_of(source)); }

ReadPlanes kept_planes(const FrameInputs& inputs) {
  ReadPlanes planes;
  for (const auto& row : kRawPlanes)
    if (const gpu::Buffer* plane = inputs[row.plane]) {
      const auto values = plane->as<const float>();
      planes[row.plane].assign(values.begin(), values.end());
    }
  return planes;
}

void read_for_parts(FrameSource& source, const Settings& settings, ReadPlanes& known, std::uint64_t most_bytes) {
  const bool is_read = !are_of(known, source);
  ReadPlanes planes = std::exchange(known, {});  // where reading fails, there are none
  if (is_read) {
    std::vector<PlaneRead> reads;
    for (const auto& row : kRawPlanes) {
      planes[row.plane].assign(source.channels[row.plane].size() * source.reading.data.pixels(), 0);
      reads.push_back({&source.channels[row.plane], planes[row.plane].data()});
    }
    read_planes(source, source.reading.data, reads);
  }
  if (!source.evidence)
    settle_by_planes(source, settings.input, planes[RawPlane::depth], planes[RawPlane::normal], most_bytes);
  if (is_read) cut_ramps(source.reading, planes[RawPlane::depth]);
  known = std::move(planes);
}

FrameInputs load_frame(gpu::Recorder& gpu, FrameSource& source, const Window& window, const Settings& settings,
                       int frame, const ReadPlanes* known) {
  RawPlaneArray<gpu::Buffer*> planes;
  std::vector<PlaneRead> reads;
  const bool is_known = known && are_of(*known, source);
  const Window& whole = source.reading.data;
  const std::size_t pixels = window.pixels(), of_file = whole.pixels();
  for (const auto& row : kRawPlanes) {
    const auto& channels = source.channels[row.plane];
    if (channels.empty()) continue;
    planes[row.plane] = &gpu.buffer(row.name, channels.size() * pixels * sizeof(float), gpu::Use::upload);
    float* const to = planes[row.plane]->as<float>().data();
    if (!is_known) reads.push_back({&channels, to});
    for (std::size_t c = 0; is_known && c < channels.size(); c++)
      copy_common((*known)[row.plane].data() + c * of_file, whole, to + c * pixels, window);
  }
  if (!is_known) read_planes(source, window, reads);
  const auto values_of = [&](RawPlane plane) {
    return planes[plane] ? planes[plane]->as<float>() : std::span<float>();
  };
  for (const auto& row : kRawPlanes)
    if (planes[row.plane]) fill_missing(source, window, row.plane, values_of(row.plane));
  if (planes[RawPlane::beauty]) require_picture(source, window, values_of(RawPlane::beauty));
  if (!source.evidence)
    settle_by_planes(source, settings.input, values_of(RawPlane::depth), values_of(RawPlane::normal));
  if (!is_known) cut_ramps(over(source.reading, window), values_of(RawPlane::depth));
  FrameInputs inputs = inputs_of(over(source.reading, window), planes, frame);
  inputs.margin = margin_of(window, whole);
  inputs.albedo_value = settings.input.albedo_value.value_or(0);
  if (source.environment) {
    inputs.environment = *source.environment;
    inputs.world_from_view = transposed(*source.reading.camera.view_from_world);
  }
  if (in_world(source.reading.camera, settings.output))
    inputs.aov_from_view = transposed(*source.reading.camera.view_from_world);
  return inputs;
}

std::vector<std::span<const float>> result_planes(const FrameOutputs& outputs, const Window& computed,
                                                  const OutputSettings& settings) {
  std::vector<std::span<const float>> results;
  const std::size_t pixels = computed.pixels();
  for (const auto& aov : aovs_of(settings)) {
    const auto planes = (outputs.*aov.planes)->as<const float>();
    const std::size_t channels = channels_of(aov, planes.size() / pixels).size();
    for (std::size_t c = 0; c < channels; c++)
      results.push_back(planes.subspan(planes.size() > pixels ? c * pixels : 0, pixels));
  }
  const auto composite = outputs.composite ? outputs.composite->as<const float>() : std::span<const float>();
  for (std::size_t at = 0; at < composite.size(); at += pixels) results.push_back(composite.subspan(at, pixels));
  if (outputs.composite && !settings.append_ao.empty()) results.push_back(outputs.ao->as<const float>());
  return results;
}

FrameWriter::FrameWriter(FrameSource& source, const Settings& all, const Provenance& provenance)
    : source_(source), row_(written_of(source).y), notes_(provenance.notes) {
  const OutputSettings& settings = all.output;
  const ExrOutput aovs = aov_file(source, all.estimator, settings, provenance);
  files_.emplace_back(settings.output, aovs);
  planes_.push_back(aovs.planes.size());
  if (settings.composite.empty()) return;
  const ExrOutput composite = composite_file(source, all, provenance);
  files_.emplace_back(settings.composite, composite);
  planes_.push_back(composite.planes.size());
  if (composite.data != aovs.data) composite_row_ = composite.data.y;
  computed_row_ = aovs.data.y;
}

void FrameWriter::write(std::span<const std::span<const float>> planes) {
  if (source_.reading.supersampling == 1) return write_pixels(planes);
  Window rows = written_of(source_);
  rows.y = row_;
  rows.height = int(planes[0].size() / std::size_t(rows.width));
  row_ += rows.height;
  if (picture_of(source_.reading, rows).pixels() == 0) return;
  std::vector<std::vector<float>> pixels;
  for (const auto& plane : planes)
    pixels.push_back(middle_pixels(plane, rows, source_.reading.display, source_.reading.supersampling));
  write_pixels(std::vector<std::span<const float>>(pixels.begin(), pixels.end()));
}

void FrameWriter::write_pixels(std::span<const std::span<const float>> planes) {
  for (std::size_t i = 0; i < files_.size(); i++) {
    const auto rows = planes.first(planes_[i]);
    if (i > 0 && composite_row_)
      write_composite(rows);
    else
      files_[i].write(rows);
    planes = planes.subspan(planes_[i]);
  }
}

void FrameWriter::write_composite(std::span<const std::span<const float>> planes) {
  Window from = written_picture(source_);
  from.y = computed_row_;
  from.height = int(planes[0].size() / std::size_t(from.width));
  write_composite_until(from.y, {}, {});
  write_composite_until(computed_row_ += from.height, from, planes);
}

void FrameWriter::write_composite_until(int bottom, const Window& from,
                                        std::span<const std::span<const float>> planes) {
  const Window window = composite_window(source_);
  const int step = int(std::clamp<std::uint64_t>(kBytesAtOnce / row_bytes(source_), kRowsOfOutput, 1 << 20));
  for (const int end = std::min(bottom, window.y + window.height); *composite_row_ < end;) {
    const Window part{window.x, *composite_row_, window.width, std::min(step, end - *composite_row_)};
    const auto composite = composite_over(source_, planes_.back(), part, from, planes);
    files_.back().write(std::vector<std::span<const float>>(composite.begin(), composite.end()));
    *composite_row_ += part.height;
  }
}

void FrameWriter::finish(const std::string& notes) {
  std::map<std::string, std::string> late;
  if (notes != notes_) late[kNotesAttribute] = notes;
  if (composite_row_) write_composite_until(std::numeric_limits<int>::max(), {}, {});
  for (auto& file : files_) file.finish(late);
}

std::string radius_text(const EstimatorSettings& estimator) {
  return estimator.radius ? fmt::format("{}", fmt::join(radii_of(estimator), " ")) : "";
}

std::string made_by(const std::string& options, const std::string& inputs) { return options + " " + inputs; }

}  // namespace alcove
