// Finding, uploading and writing the planes of a frame.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frame_files.h"

#include <algorithm>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/version.h"
#include "core/chain/aov.h"
#include "core/frame/settle.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

/// Whether the directions that are written are in world space.
bool in_world(const FrameSource& source, const OutputSettings& settings) {
  return settings.aov_space != NormalSpace::view && source.camera.view_from_world.has_value();
}

ExrOutput output_like(const FrameSource& source, const ChannelRef& like, const Provenance& provenance) {
  ExrOutput output;
  output.data = written_of(source);
  output.display = source.display;
  output.pixel_aspect = source.pixel_aspect;
  output.attributes = source.files[like.file].attributes(like.part);
  output.own_attributes = {{"alcove/version", kVersion},
                           {"alcove/options", provenance.options},
                           {"alcove/device", provenance.device},
                           {"alcove/inputs", provenance.inputs},
                           {"alcove/input", fs::path(source.files[source.depth[0].file].path()).filename().string()}};
  return output;
}

SampleType type_of(const FrameSource& source, const ChannelRef& ref) {
  const auto& channels = source.files[ref.file].parts()[std::size_t(ref.part)].channels;
  const auto found = std::ranges::find(channels, ref.channel, &ExrChannel::name);
  return found != channels.end() && found->type == SampleType::half_float ? SampleType::half_float
                                                                          : SampleType::single_float;
}

/// The AO file, without pixels.
ExrOutput aov_file(const FrameSource& source, const EstimatorSettings& estimator, const OutputSettings& settings,
                   const Provenance& provenance) {
  ExrOutput output = output_like(source, source.depth[0], provenance);
  output.compression = settings.compression;
  const auto radii = estimator.radius ? radii_of(estimator) : std::vector<double>();
  for (const auto& aov : aovs_of(settings)) {
    const SampleType type =
        settings.type == OutputType::half_float && !aov.is_float ? SampleType::half_float : SampleType::single_float;
    for (const auto& channel : channels_of(aov, radii.size())) output.planes.push_back({channel, type, {}});
  }
  if (wants(settings, &FrameOutputs::scales))
    output.own_attributes["alcove/radii"] = fmt::format("{}", fmt::join(radii, " "));
  if (wants(settings, &FrameOutputs::normal) || wants(settings, &FrameOutputs::bent_normal))
    output.own_attributes["alcove/normal_space"] = in_world(source, settings) ? "world" : "view";
  return output;
}

/// The composite, without pixels. Every channel keeps the beauty's precision.
ExrOutput composite_file(const FrameSource& source, const OutputSettings& settings, const Provenance& provenance) {
  ExrOutput output = output_like(source, source.beauty[0], provenance);
  output.own_attributes["alcove/composite"] =
      source.indirect.empty() ? "multiply: beauty * ao" : "ambient: beauty - D + D * ao, D = indirect diffuse";
  if (settings.multi_bounce) output.own_attributes["alcove/composite"] += "; ao with multi-bounce";
  if (settings.fog_density > 0)
    output.own_attributes["alcove/composite"] +=
        fmt::format("; ao seen through fog of density {}", settings.fog_density);
  const char* names[] = {"R", "G", "B", "A"};
  for (std::size_t c = 0; c < source.beauty.size(); c++)
    output.planes.push_back({names[c], type_of(source, source.beauty[c]), {}});
  return output;
}

/// Fails with ErrorKind::input where a frame lacks what an output is made from.
void require_for_outputs(const FrameSource& source, const OutputSettings& settings) {
  const std::string& file = source.files[source.depth[0].file].path();
  if (settings.aov_space == NormalSpace::world && !source.camera.view_from_world)
    fail(ErrorKind::input, "{}: --aov-space world needs a camera with world_to_camera: give a --camera file with it",
         file);
  if (settings.multi_bounce && !source.beauty.empty() && source.indirect.empty())
    fail(ErrorKind::input,
         "{}: --multi-bounce is for indirect light, and the frame has no indirect diffuse part for the --composite "
         "(--beauty)",
         file);
  for (const auto* view : debug_views_of(settings)) {
    if (view->source == DebugSource::raw_depth && source.depth.size() > 1)
      fail(ErrorKind::input,
           "{}: --debug {} shows a depth, and the frame has positions: name one with --depth-channel, or see "
           "linear-depth",
           file, view->name);
    if (view->source == DebugSource::normals_from_depth && source.normal.empty())
      fail(ErrorKind::input,
           "{}: --debug {} compares the frame's normals with those from depth, and there are none (--normal, "
           "--normal-channels)",
           file, view->name);
  }
}

}  // namespace

FrameSource open_frame(const Settings& settings, int frame) {
  FrameSource source = find_frame(settings.input, !settings.output.composite.empty(), frame,
                                  settings.output.multi_bounce && !settings.input.albedo_value);
  if (settings.input.roi) source.region = region_of(source, *settings.input.roi);
  require_for_outputs(source, settings.output);
  return source;
}

const Window& written_of(const FrameSource& source) { return source.region ? *source.region : source.file_data; }

FrameInputs load_frame(gpu::Recorder& gpu, FrameSource& source, const Settings& all, int frame) {
  const InputSettings& settings = all.input;
  if (!source.settled && source.data.pixels() > kEvidencePixels) settle_by_rows(source, settings);
  FrameInputs inputs;
  inputs.view = view_of(source.camera, source.data, source.display);
  inputs.noise_origin = {source.data.x - source.display.x, source.data.y - source.display.y};
  inputs.frame = frame;
  inputs.has_alpha = source.beauty.size() == 4;
  inputs.albedo_value = settings.albedo_value.value_or(0);
  if (in_world(source, all.output))
    for (std::size_t row = 0; row < 3; row++)
      for (std::size_t column = 0; column < 3; column++)
        inputs.aov_from_view[row][column] = (*source.camera.view_from_world)[column][row];

  std::vector<PlaneRead> reads;
  const auto upload = [&](const char* name, const std::vector<ChannelRef>& channels) -> gpu::Buffer* {
    if (channels.empty()) return nullptr;
    gpu::Buffer& buffer = gpu.buffer(name, channels.size() * source.data.pixels() * sizeof(float), gpu::Use::upload);
    reads.push_back({&channels, buffer.as<float>().data()});
    return &buffer;
  };
  inputs.depth = upload("raw depth", source.depth);
  inputs.normal = upload("raw normal", source.normal);
  inputs.beauty = upload("beauty", source.beauty);
  inputs.indirect = upload("indirect", source.indirect);
  inputs.diffuse_color = upload("diffuse color", source.diffuse_color);
  inputs.material_ao = upload("material ao", source.material_ao);
  inputs.albedo = upload("albedo", source.albedo);
  read_planes(source, reads);
  if (!source.settled)
    settle(source, settings, inputs.depth->as<float>(),
           inputs.normal ? inputs.normal->as<float>() : std::span<float>());
  inputs.depth_map = depth_map_of(source, settings);
  inputs.is_sky = is_all_sky(inputs.depth_map, inputs.depth->as<const float>());
  inputs.depth_precision =
      depth_precision(inputs.depth_map, has_half_depth(source) ? kHalfPrecision : kFloatPrecision, source.depth_step);
  if (inputs.normal) inputs.view_from_normal = view_from_normal(source.camera, source.normal_space, source.flip_normal);
  inputs.normal_encoding = source.normal_encoding;
  inputs.normal_unorm = source.normal_unorm;
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
  return results;
}

FrameWriter::FrameWriter(const FrameSource& source, const Settings& all, const Provenance& provenance) {
  const OutputSettings& settings = all.output;
  const auto add = [&](const std::string& path, const ExrOutput& output) {
    files_.emplace_back(path, output);
    planes_.push_back(output.planes.size());
  };
  add(settings.output, aov_file(source, all.estimator, settings, provenance));
  if (!settings.composite.empty()) add(settings.composite, composite_file(source, settings, provenance));
}

void FrameWriter::write(std::span<const std::span<const float>> planes) {
  for (std::size_t i = 0; i < files_.size(); i++) {
    files_[i].write(planes.first(planes_[i]));
    planes = planes.subspan(planes_[i]);
  }
}

void FrameWriter::finish() {
  for (auto& file : files_) file.finish();
}

std::string made_by(const std::string& options, const std::string& inputs) { return options + " " + inputs; }

}  // namespace alcove
