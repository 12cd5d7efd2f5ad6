// Finding, uploading and writing the planes of a frame.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_files.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/base/file.h"
#include "core/base/option_words.h"
#include "core/base/version.h"
#include "core/base/windows.h"
#include "core/chain/aov.h"
#include "core/chain/margin.h"
#include "core/frame/behind.h"
#include "core/frame/plane_windows.h"
#include "core/frame/settle.h"
#include "core/run/pictures.h"

namespace alcove {
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
  output.display = picture_of(source, source.display);
  output.pixel_aspect = source.pixel_aspect;
  output.attributes = source.files[like.file].attributes(like.part);
  output.own_attributes = {{"alcove/version", kVersion},
                           {"alcove/options", provenance.options},
                           {"alcove/device", provenance.device},
                           {"alcove/inputs", provenance.inputs},
                           {"alcove/input", fs::path(source.depth_path()).filename().string()}};
  if (source.supersampling > 1)
    output.own_attributes["alcove/filter"] =
        fmt::format("{} x {} px by {}", source.supersampling, source.supersampling, text_of(settings.filter));
  if (const std::string hidden = hidden_sources_text(source); !hidden.empty())
    output.own_attributes[kHiddenAttribute] = hidden;
  if (!provenance.others.empty()) {
    std::string& hidden_from = output.own_attributes[kHiddenAttribute];
    hidden_from += (hidden_from.empty() ? "" : "; ") + provenance.others;
  }
  if (!provenance.estimates.empty()) output.own_attributes[kAccumulatedAttribute] = provenance.estimates;
  if (!provenance.notes.empty()) output.own_attributes[kNotesAttribute] = provenance.notes;
  return output;
}

SampleType type_of(const FrameSource& source, const ChannelRef& ref) {
  const auto& channels = source.part_of(ref).channels;
  const auto found = std::ranges::find(channels, ref.channel, &ExrChannel::name);
  return found != channels.end() && found->type == SampleType::half_float ? SampleType::half_float
                                                                          : SampleType::single_float;
}

/// The AO file, without pixels.
ExrOutput aov_file(const FrameSource& source, const EstimatorSettings& estimator, const OutputSettings& settings,
                   const Provenance& provenance) {
  ExrOutput output = output_like(source, source[RawPlane::depth][0], written_picture(source), settings, provenance);
  output.compression = settings.compression;
  const auto radii = estimator.radius ? radii_of(estimator) : std::vector<double>();
  if (needs_ao(settings)) output.own_attributes["alcove/radius"] = fmt::format("{}", fmt::join(radii, " "));
  for (const auto& aov : aovs_of(settings)) {
    const SampleType type =
        settings.type == OutputType::half_float && !aov.is_float ? SampleType::half_float : SampleType::single_float;
    for (const auto& channel : channels_of(aov, planes_of(aov, estimator)))
      output.planes.push_back({channel, type, {}});
  }
  if (wants(settings, &FrameOutputs::scales))
    output.own_attributes["alcove/radii"] = fmt::format("{}", fmt::join(radii, " "));
  if (wants(settings, &FrameOutputs::normal) || wants(settings, &FrameOutputs::bent_normal))
    output.own_attributes["alcove/normal_space"] = in_world(source.camera, settings) ? "world" : "view";
  return output;
}

/// What the composite is made by, in words.
std::string composite_text(const FrameSource& source, const Settings& all) {
  const CompositeLook& look = all.output.look;
  std::string text = "multiply: beauty * ao";
  if (!source[RawPlane::indirect].empty())
    text = fmt::format("ambient: beauty - D + D * ao, D = {}",
                       all.input.ambient.empty() ? "indirect diffuse" : all.input.ambient);
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

SampleType type_of(const OutputSettings& settings) {
  return settings.type == OutputType::half_float ? SampleType::half_float : SampleType::single_float;
}

/// Whether the composite is a copy of the beauty's file, which is an EXR.
bool keeps_layers(const FrameSource& source, const OutputSettings& settings) {
  return settings.composite_layers == "all" && source.files[source[RawPlane::beauty][0].file].codec_group() > 0;
}

/// The composite, without pixels. Every channel keeps the beauty's precision.
ExrOutput composite_file(const FrameSource& source, const Settings& all, const Provenance& provenance) {
  const OutputSettings& settings = all.output;
  ExrOutput output = output_like(source, source[RawPlane::beauty][0], composite_window(source), settings, provenance);
  output.own_attributes["alcove/composite"] = composite_text(source, all);
  output.compression = settings.composite_compression;
  const char* names[] = {"R", "G", "B", "A"};
  for (std::size_t c = 0; c < source[RawPlane::beauty].size(); c++)
    output.planes.push_back({names[c], type_of(source, source[RawPlane::beauty][c]), {}});
  if (!settings.append_ao.empty()) output.planes.push_back({appended_channel(settings), type_of(settings), {}});
  return output;
}

/// The same as a copy of the beauty's file.
ExrCopySettings composite_copy(const FrameSource& source, const ExrOutput& composite) {
  const auto& beauty = source[RawPlane::beauty];
  ExrCopySettings copy{
      source.files[beauty[0].file].path(), composite.data, composite.compression, {}, composite.own_attributes};
  for (std::size_t c = 0; c < composite.planes.size(); c++) {
    const bool is_beauty = c < beauty.size();
    const ChannelRef& place = beauty[is_beauty ? c : 0];
    copy.planes.push_back(
        {place.part, is_beauty ? place.channel : composite.planes[c].channel, composite.planes[c].type});
  }
  return copy;
}

/// Fails where the AO has no place in the composite.
void require_place_for_ao(const FrameSource& source, const OutputSettings& settings) {
  if (settings.append_ao.empty() || source[RawPlane::beauty].empty()) return;
  const std::string channel = appended_channel(settings);
  const ChannelRef& beauty = source[RawPlane::beauty][0];
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
void require_picture(const FrameSource& source, std::span<const float> beauty) {
  const auto colors = beauty.first(3 * source.data.pixels());
  if (source.data != source.file_data) return;  // a part may be of one colour
  for (std::size_t c = 0; c < 3; c++) {
    const auto plane = colors.subspan(c * source.data.pixels(), source.data.pixels());
    if (std::ranges::any_of(plane, [&](float x) { return !(x == plane[0]); })) return;
  }
  const ChannelRef& red = source[RawPlane::beauty][0];
  fail(ErrorKind::input,
       "{}: the beauty {} has one colour in all pixels{}: give the picture with --beauty, or name it with "
       "--set beauty-channels",
       source.files[red.file].path(), red.channel,
       colors[0] == 0 ? ", black, as renderers write a layer that they did not render" : "");
}

/// Fails with ErrorKind::usage where deep samples beside a flat depth are of no use to the estimator. Only now it is
/// known whether they are beside one.
void require_use_of_deep(const FrameSource& source, const EstimatorSettings& settings) {
  const bool has_use = searches_slices(settings) || settings.hidden == 0 || !source.deep;
  if (has_use || source.part_of(source[RawPlane::depth][0]).deep) return;
  fail(ErrorKind::usage,
       "{}: beside a flat depth --deep applies to --estimator gtao or bitmask only: give one of these, or --set "
       "hidden=0, "
       "or leave --deep out",
       source.files[*source.deep].path());
}

/// Fails with ErrorKind::input where a frame lacks what an output is made from.
void require_for_outputs(const FrameSource& source, const OutputSettings& settings) {
  const std::string& file = source.depth_path();
  if (settings.aov_space == NormalSpace::world && !source.camera.view_from_world)
    fail(ErrorKind::input,
         "{}: --set aov-space=world needs a camera with world_to_camera: give a --camera file with it", file);
  if (settings.multi_bounce && !source[RawPlane::beauty].empty() && source[RawPlane::indirect].empty())
    fail(ErrorKind::input,
         "{}: --set multi-bounce is for indirect light, and the frame has no indirect diffuse part for the --composite "
         "(--beauty)",
         file);
  require_place_for_ao(source, settings);
  for (const auto* view : debug_views_of(settings)) {
    if (view->source == DebugSource::raw_depth && source[RawPlane::depth].size() > 1)
      fail(ErrorKind::input,
           "{}: --set debug={} shows a depth, and the frame has positions: name one with --depth-channel, or see "
           "linear-depth",
           file, view->name);
    if (view->source == DebugSource::normals_from_depth && source[RawPlane::normal].empty())
      fail(ErrorKind::input,
           "{}: --set debug={} compares the frame's normals with those from depth, and there are none (--normal, "
           "--normal-channels)",
           file, view->name);
  }
}

}  // namespace

FrameSource open_frame(const Settings& settings, int frame) {
  FrameSource source = find_frame(settings.input, !settings.output.composite.empty(), frame,
                                  settings.output.multi_bounce && !settings.input.albedo_value);
  require_use_of_deep(source, settings.estimator);
  if (settings.estimator.hidden == 0) {
    source[RawPlane::behind].clear();
    source.behind.clear();
  }
  if (settings.input.roi) source.region = region_of(source, *settings.input.roi);
  if (source.region && !source[RawPlane::beauty].empty() && composite_window(source).pixels() == 0)
    fail(ErrorKind::usage,
         "{}: the beauty has no pixel of --roi, which is {}: give a region within it, or no --composite",
         source.files[source[RawPlane::beauty][0].file].path(), to_string(*source.region));
  require_for_outputs(source, settings.output);
  return source;
}

const Window& written_of(const FrameSource& source) { return source.region ? *source.region : source.file_data; }

Window written_picture(const FrameSource& source) { return picture_of(source, written_of(source)); }

ReadPlanes kept_planes(const FrameInputs& inputs) {
  ReadPlanes planes;
  for (const auto& row : kRawPlanes)
    if (const gpu::Buffer* plane = inputs[row.plane]) {
      const auto values = plane->as<const float>();
      planes[row.plane].assign(values.begin(), values.end());
    }
  return planes;
}

ReadPlanes read_whole(FrameSource& source) {
  ReadPlanes planes;
  std::vector<PlaneRead> reads;
  for (const auto& row : kRawPlanes) {
    planes[row.plane].resize(source[row.plane].size() * source.file_data.pixels());
    reads.push_back({&source[row.plane], planes[row.plane].data()});
  }
  read_planes(source, reads);
  return planes;
}

bool are_of(const ReadPlanes& planes, const FrameSource& source) {
  return std::ranges::all_of(kRawPlanes, [&](const auto& row) {
    return source[row.plane].empty() ||
           planes[row.plane].size() == source[row.plane].size() * source.file_data.pixels();
  });
}

RawPlaneArray<gpu::Buffer*> read_frame(gpu::Recorder& gpu, FrameSource& source, const ReadPlanes* known) {
  RawPlaneArray<gpu::Buffer*> planes;
  std::vector<PlaneRead> reads;
  const bool is_known = known && are_of(*known, source);
  const std::size_t pixels = source.data.pixels(), of_file = source.file_data.pixels();
  for (const auto& row : kRawPlanes) {
    const auto& channels = source[row.plane];
    if (channels.empty()) continue;
    planes[row.plane] = &gpu.buffer(row.name, channels.size() * pixels * sizeof(float), gpu::Use::upload);
    float* const to = planes[row.plane]->as<float>().data();
    if (!is_known) reads.push_back({&channels, to});
    for (std::size_t c = 0; is_known && c < channels.size(); c++)
      copy_common((*known)[row.plane].data() + c * of_file, source.file_data, to + c * pixels, source.data);
  }
  if (!is_known) read_planes(source, reads);
  for (const auto& row : kRawPlanes)
    if (planes[row.plane]) fill_missing(source, row.plane, planes[row.plane]->as<float>());
  return planes;
}

FrameInputs settled_inputs(FrameSource& source, const RawPlaneArray<gpu::Buffer*>& planes, const Settings& all,
                           int frame) {
  const InputSettings& settings = all.input;
  const auto values_of = [&](RawPlane plane) {
    return planes[plane] ? planes[plane]->as<float>() : std::span<float>();
  };
  if (planes[RawPlane::beauty]) require_picture(source, values_of(RawPlane::beauty));
  if (!source.settled) settle_by_planes(source, settings, values_of(RawPlane::depth), values_of(RawPlane::normal));
  FrameInputs inputs = inputs_of(source, planes, frame);
  inputs.margin = margin_of(source.data, source.file_data);
  inputs.albedo_value = settings.albedo_value.value_or(0);
  if (in_world(source.camera, all.output)) inputs.aov_from_view = transposed(*source.camera.view_from_world);
  return inputs;
}

FrameInputs load_frame(gpu::Recorder& gpu, FrameSource& source, const Settings& all, int frame,
                       const ReadPlanes* known) {
  return settled_inputs(source, read_frame(gpu, source, known), all, frame);
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
  files_.emplace_back(ExrWriter(settings.output, aovs));
  planes_.push_back(aovs.planes.size());
  if (settings.composite.empty()) return;
  const ExrOutput composite = composite_file(source, all, provenance);
  if (keeps_layers(source, settings))
    files_.emplace_back(ExrCopy(settings.composite, composite_copy(source, composite)));
  else
    files_.emplace_back(ExrWriter(settings.composite, composite));
  planes_.push_back(composite.planes.size());
  if (composite_window(source) != written_picture(source))
    composite_.emplace(source, written_picture(source), composite.planes.size());
}

void FrameWriter::write(std::span<const std::span<const float>> planes) {
  if (source_.supersampling == 1) return write_pixels(planes);
  Window rows = written_of(source_);
  rows.y = row_;
  rows.height = int(planes[0].size() / std::size_t(rows.width));
  row_ += rows.height;
  if (picture_of(source_, rows).pixels() == 0) return;
  std::vector<std::vector<float>> pixels;
  for (const auto& plane : planes) pixels.push_back(middle_pixels(plane, rows, source_.display, source_.supersampling));
  write_pixels(std::vector<std::span<const float>>(pixels.begin(), pixels.end()));
}

void FrameWriter::write_pixels(std::span<const std::span<const float>> planes) {
  for (std::size_t i = 0; i < files_.size(); i++) {
    const auto write = [&](std::span<const std::span<const float>> rows) {
      std::visit([&](auto& file) { file.write(rows); }, files_[i]);
    };
    if (i > 0 && composite_)
      composite_->write(planes.first(planes_[i]), write);
    else
      write(planes.first(planes_[i]));
    planes = planes.subspan(planes_[i]);
  }
}

void FrameWriter::finish(const std::string& notes) {
  std::map<std::string, std::string> late;
  if (notes != notes_) late[kNotesAttribute] = notes;
  if (composite_)
    composite_->finish([&](std::span<const std::span<const float>> rows) {
      std::visit([&](auto& file) { file.write(rows); }, files_.back());
    });
  for (auto& file : files_) std::visit([&](auto& open) { open.finish(late); }, file);
}

std::string made_by(const std::string& options, const std::string& inputs) { return options + " " + inputs; }

}  // namespace alcove
