// Reads a frame, runs the chain, writes what was asked for.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/batch.h"

#include <sys/resource.h>
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "core/aov.h"
#include "core/chain.h"
#include "core/color.h"
#include "core/error.h"
#include "core/exr.h"
#include "core/file.h"
#include "core/gbuffer.h"
#include "core/image_io.h"
#include "core/region.h"
#include "core/settle.h"
#include "core/version.h"
#include "kernels/prepare.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRadii = 8;

class Stopwatch {
 public:
  double ms() const { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct OutputFile {
  const char* option;
  std::string path;
};

std::vector<OutputFile> outputs_of(const OutputSettings& output) {
  std::vector<OutputFile> files{{"--output", output.output}, {"--composite", output.composite}, {"--preview", output.preview}, {"--stats", output.stats}};
  for (const auto* view : debug_views_of(output)) files.push_back({"--debug", debug_path(output, *view)});
  std::erase_if(files, [](const OutputFile& file) { return file.path.empty(); });
  return files;
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path whole_a = fs::weakly_canonical(a, error), whole_b = error ? fs::path() : fs::weakly_canonical(b, error);
  return error ? a == b : whole_a == whole_b;
}

/// The largest buffer holds as many planes as the widest AOV has channels.
void require_room(const FrameSource& source, const Settings& settings, const gpu::DeviceInfo& device) {
  const std::size_t planes = std::max<std::size_t>(1 + settings.estimator.further_radii.size(), needs_bent(settings.estimator, settings.output) ? 3 : 1);
  if (const std::uint64_t bytes = planes * source.data.pixels() * sizeof(float); bytes > device.buffer_bytes)
    fail(ErrorKind::device, "{}: {} planes of {} pixels need a buffer of {} MiB, and {} takes {} MiB: use another --device, fewer --radius, or a smaller frame",
         source.files[source.depth[0].file].path(), planes, source.data.pixels(), bytes >> 20, device.name, device.buffer_bytes >> 20);
  for (const auto* aov : {&source.depth, &source.normal, &source.beauty, &source.indirect, &source.diffuse_color, &source.albedo, &source.material_ao})
    if (const std::uint64_t bytes = aov->size() * source.data.pixels() * sizeof(float); bytes > device.buffer_bytes)
      fail(ErrorKind::device, "{}: {} pixels of {} channels need a buffer of {} MiB, and {} takes {} MiB: use another --device, or a smaller frame",
           source.files[aov->front().file].path(), to_string(source.data), aov->size(), bytes >> 20, device.name, device.buffer_bytes >> 20);
}

/// Whether the directions that are written are in world space.
bool in_world(const FrameSource& source, const OutputSettings& settings) {
  return settings.aov_space != NormalSpace::view && source.camera.view_from_world.has_value();
}

/// The planes that were found, in upload buffers, and what they mean.
FrameInputs read_frame(gpu::Recorder& gpu, FrameSource& source, const InputSettings& settings, const OutputSettings& output, int frame) {
  FrameInputs inputs;
  inputs.view = view_of(source.camera, source.data, source.display);
  inputs.noise_origin = {source.data.x - source.display.x, source.data.y - source.display.y};
  inputs.frame = frame;
  inputs.has_alpha = source.beauty.size() == 4;
  inputs.albedo_value = settings.albedo_value.value_or(0);
  if (in_world(source, output))
    for (std::size_t row = 0; row < 3; row++)
      for (std::size_t column = 0; column < 3; column++) inputs.aov_from_view[row][column] = (*source.camera.view_from_world)[column][row];

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
  if (!source.settled) settle(source, settings, inputs.depth->as<float>(), inputs.normal ? inputs.normal->as<float>() : std::span<float>());
  inputs.depth_map = depth_map_of(source, settings);
  if (inputs.normal) inputs.view_from_normal = view_from_normal(source.camera, source.normal_space, source.flip_normal);
  inputs.normal_encoding = source.normal_encoding;
  inputs.normal_unorm = source.normal_unorm;
  return inputs;
}

ExrOutput output_like(const FrameSource& source, const ChannelRef& like, const std::string& digest, const std::string& device) {
  ExrOutput output;
  output.data = source.data;
  output.display = source.display;
  output.pixel_aspect = source.pixel_aspect;
  output.attributes = source.files[like.file].attributes(like.part);
  output.own_attributes = {{"alcove/version", kVersion},
                           {"alcove/options", digest},
                           {"alcove/device", device},
                           {"alcove/input", fs::path(source.files[source.depth[0].file].path()).filename().string()}};
  return output;
}

/// What is written of a buffer's planes: all, or the region; empty for null.
using Planes = std::function<std::span<const float>(const gpu::Buffer*)>;

void write_aovs(const FrameSource& source, const FrameOutputs& outputs, const Planes& planes_of, const EstimatorSettings& estimator,
                const OutputSettings& settings, const std::string& digest, const std::string& device) {
  ExrOutput output = output_like(source, source.depth[0], digest, device);
  output.compression = settings.compression;
  const std::size_t pixels = source.data.pixels();
  for (const auto& aov : aovs_of(settings)) {
    const auto planes = planes_of(outputs.*aov.planes);
    const SampleType type = settings.type == OutputType::half_float && !aov.is_float ? SampleType::half_float : SampleType::single_float;
    const auto channels = channels_of(aov, planes.size() / pixels);
    for (std::size_t c = 0; c < channels.size(); c++)
      output.planes.push_back({channels[c], type, planes.subspan(planes.size() > pixels ? c * pixels : 0, pixels)});
  }
  if (outputs.scales) output.own_attributes["alcove/radii"] = fmt::format("{}", fmt::join(radii_of(estimator), " "));
  if (outputs.normal || outputs.bent_normal) output.own_attributes["alcove/normal_space"] = in_world(source, settings) ? "world" : "view";
  write_exr(settings.output, output);
}

SampleType type_of(const FrameSource& source, const ChannelRef& ref) {
  const auto& channels = source.files[ref.file].parts()[std::size_t(ref.part)].channels;
  const auto found = std::ranges::find(channels, ref.channel, &ExrChannel::name);
  return found != channels.end() && found->type == SampleType::half_float ? SampleType::half_float : SampleType::single_float;
}

/// Every channel keeps the beauty's precision.
void write_composite(const FrameSource& source, std::span<const float> composite, const OutputSettings& settings, const std::string& digest,
                     const std::string& device) {
  ExrOutput output = output_like(source, source.beauty[0], digest, device);
  output.own_attributes["alcove/composite"] = source.indirect.empty() ? "multiply: beauty * ao" : "ambient: beauty - D + D * ao, D = indirect diffuse";
  if (settings.multi_bounce) output.own_attributes["alcove/composite"] += "; ao with multi-bounce";
  if (settings.fog_density > 0) output.own_attributes["alcove/composite"] += fmt::format("; ao seen through fog of density {}", settings.fog_density);
  const char* names[] = {"R", "G", "B", "A"};
  for (std::size_t c = 0; c < source.beauty.size(); c++)
    output.planes.push_back({names[c], type_of(source, source.beauty[c]), composite.subspan(c * source.data.pixels(), source.data.pixels())});
  write_exr(settings.composite, output);
}

/// The display window of `planes` planes, interleaved; black where there are no pixels.
std::vector<float> displayed(const FrameSource& source, std::span<const float> pixels, int planes) {
  const Window &data = source.data, &display = source.display;
  std::vector<float> interleaved(display.pixels() * std::size_t(planes));
  for (int y = std::max(data.y, display.y); y < std::min(data.y + data.height, display.y + display.height); y++)
    for (int x = std::max(data.x, display.x); x < std::min(data.x + data.width, display.x + display.width); x++)
      for (int c = 0; c < planes; c++)
        interleaved[(std::size_t(y - display.y) * std::size_t(display.width) + std::size_t(x - display.x)) * std::size_t(planes) + std::size_t(c)] =
            pixels[std::size_t(c) * data.pixels() + std::size_t(y - data.y) * std::size_t(data.width) + std::size_t(x - data.x)];
  return interleaved;
}

/// The composite through the view transform; AO by itself is data, and shown as it is: no transform.
void write_preview(const FrameSource& source, std::span<const float> ao, std::span<const float> composite, const DisplayTransform* transform,
                   const OutputSettings& settings) {
  const int planes = composite.empty() ? 1 : 3;
  auto pixels = displayed(source, composite.empty() ? ao : composite, planes);
  if (transform) transform->apply(pixels);
  write_png(settings.preview, source.display.width, source.display.height, planes, pixels);
}

void note_counts(FrameReport& report, const FrameCounts& counts, const FrameSource& source) {
  report.pixels = source.data.pixels();
  report.sky_pixels = counts.sky;
  report.repaired_pixels = counts.repaired_depth + counts.repaired_normals + counts.repaired_material + counts.repaired_beauty;
  if (counts.repaired_depth) report.notes.push_back(fmt::format("{} pixels had a depth that is NaN or negative; they count as sky", counts.repaired_depth));
  if (counts.repaired_normals)
    report.notes.push_back(fmt::format("{} pixels had no usable normal; it was reconstructed from depth", counts.repaired_normals));
  if (counts.repaired_material)
    report.notes.push_back(fmt::format("{} pixels of the material AO were NaN or infinite; they count as 1", counts.repaired_material));
  if (counts.repaired_beauty) report.notes.push_back(fmt::format("{} pixels of the beauty were NaN or infinite; they are 0 in the composite", counts.repaired_beauty));
  if (source.normal.empty()) report.notes.push_back("there is no normal channel; normals were reconstructed from depth (--normal, --normal-channels)");
}

/// Fails with ErrorKind::input where a frame lacks what an output is made from.
void require_for_outputs(const FrameSource& source, const OutputSettings& settings) {
  const std::string& file = source.files[source.depth[0].file].path();
  if (settings.aov_space == NormalSpace::world && !source.camera.view_from_world)
    fail(ErrorKind::input, "{}: --aov-space world needs a camera with world_to_camera: give a --camera file with it", file);
  if (settings.multi_bounce && !source.beauty.empty() && source.indirect.empty())
    fail(ErrorKind::input, "{}: --multi-bounce is for indirect light, and the frame has no indirect diffuse part for the --composite (--beauty)", file);
  for (const auto* view : debug_views_of(settings)) {
    if (view->source == DebugSource::raw_depth && source.depth.size() > 1)
      fail(ErrorKind::input, "{}: --debug {} shows a depth, and the frame has positions: name one with --depth-channel, or see linear-depth", file, view->name);
    if (view->source == DebugSource::normals_from_depth && source.normal.empty())
      fail(ErrorKind::input, "{}: --debug {} compares the frame's normals with those from depth, and there are none (--normal, --normal-channels)", file,
           view->name);
  }
}

/// `transform`: for the preview of a composite, else null.
FrameReport run_frame(gpu::Device& device, gpu::Recorder& gpu, const Settings& settings, const DisplayTransform* transform, const std::string& digest) {
  const Stopwatch total;
  FrameReport report;
  report.input = !settings.input.input.empty() ? settings.input.input : settings.input.depth.empty() ? settings.input.position : settings.input.depth;
  report.output = settings.output.output;
  report.frame = frame_number_of(report.input);

  const Stopwatch reading;
  FrameSource source = find_frame(settings.input, !settings.output.composite.empty(), report.frame, settings.output.multi_bounce && !settings.input.albedo_value);
  if (settings.input.roi) restrict_to_region(source, settings);
  require_for_outputs(source, settings.output);
  require_room(source, settings, device.info());
  const FrameInputs inputs = read_frame(gpu, source, settings.input, settings.output, report.frame);
  report.read_ms = reading.ms();

  const FrameOutputs outputs = run_chain(gpu, inputs, settings.estimator, settings.output);
  gpu.run();
  report.passes = gpu.passes();
  report.notes = source.notes;
  for (const auto& pass : report.passes) report.compute_ms += pass.ms;
  note_counts(report, outputs.counts->as<FrameCounts>()[0], source);
  if (outputs.ao) report.samples_per_pixel = samples_per_pixel(settings.estimator) * double(report.pixels - report.sky_pixels) / double(report.pixels);

  const Stopwatch writing;
  const Window computed = source.data;
  if (source.region) source.data = *source.region;
  std::deque<std::vector<float>> regions;
  const Planes planes = [&](const gpu::Buffer* buffer) {
    const auto all = buffer ? buffer->as<float>() : std::span<float>();
    return source.region ? std::span<const float>(regions.emplace_back(cropped(all, computed, *source.region))) : all;
  };
  write_aovs(source, outputs, planes, settings.estimator, settings.output, digest, device.info().name);
  if (outputs.composite) {
    write_composite(source, planes(outputs.composite), settings.output, digest, device.info().name);
    if (source.indirect.empty())
      report.notes.push_back("the frame has no indirect diffuse part: the composite is the whole beauty times AO, which dims direct light too");
  }
  if (!settings.output.preview.empty()) write_preview(source, planes(outputs.ao), planes(outputs.composite), transform, settings.output);
  for (const auto& plane : outputs.debug)
    write_debug_view(debug_path(settings.output, *plane.view), *plane.view, plane.size.x, plane.size.y, plane.values->as<float>());
  report.write_ms = writing.ms();
  report.total_ms = total.ms();
  return report;
}

/// Several radii, and what only some estimators give.
void check_scales(const Settings& settings) {
  const auto& e = settings.estimator;
  if (wants(settings.output, &FrameOutputs::bent_normal) && !has_bent_normals(e.estimator))
    fail(ErrorKind::usage, "--aov bent-normal: --estimator {} finds no open directions; gtao and bitmask do", e.estimator == Estimator::hbao ? "hbao" : "crytek");
  if (e.further_radii.empty()) return;
  const auto radii = radii_of(e);
  if (radii.size() > kMostRadii) fail(ErrorKind::usage, "--radius: there are {}, and at most {} scales", radii.size(), kMostRadii);
  if (const auto twice = std::ranges::adjacent_find(radii); twice != radii.end()) fail(ErrorKind::usage, "--radius {} is there twice: give each scale once", *twice);
}

/// What goes into the shading of the AO.
void check_shading(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& o = settings.output;
  if (e.fade_start.has_value() != e.fade_end.has_value()) fail(ErrorKind::usage, "--fade-start and --fade-end belong together: depths in scene units");
  if (e.fade_end && *e.fade_end <= *e.fade_start) fail(ErrorKind::usage, "--fade-end {} is not beyond --fade-start {}", *e.fade_end, *e.fade_start);
  const bool has_albedo = !settings.input.albedo.empty() || settings.input.albedo_value || !settings.input.albedo_channels.empty();
  if (has_albedo && !o.multi_bounce) fail(ErrorKind::usage, "--albedo and --albedo-channels are for --multi-bounce: give it too");
  if (o.multi_bounce && o.composite.empty() && !wants(o, &FrameOutputs::color_ao))
    fail(ErrorKind::usage, "--multi-bounce shows in the AO with --ao-channels rgb, and in a --composite: ask for one of them");
  if (o.fog_density > 0 && o.composite.empty()) fail(ErrorKind::usage, "--fog-density is for a composite: name its file with --composite");
}

}  // namespace

void check_settings(const Settings& settings) {
  if (settings.output.output.empty()) fail(ErrorKind::usage, "no output: name the AO file with -o FILE.exr");
  if (settings.input.input.empty() && settings.input.depth.empty() && settings.input.position.empty())
    fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
  if (!settings.input.depth.empty() && !settings.input.position.empty()) fail(ErrorKind::usage, "--depth and --position are two ways to say the same: give one");
  if (!settings.estimator.radius && needs_ao(settings.output)) fail(ErrorKind::usage, "no radius: say with --radius how far occluders reach, in scene units");
  check_scales(settings);
  if (settings.estimator.estimator != Estimator::crytek && settings.estimator.bias >= 1)
    fail(ErrorKind::usage, "--bias {}: of every estimator but crytek it is the sine of an elevation, below 1", settings.estimator.bias);
  if (settings.estimator.falloff_end <= settings.estimator.falloff_start)
    fail(ErrorKind::usage, "--falloff-end {} is not above --falloff-start {}", settings.estimator.falloff_end, settings.estimator.falloff_start);
  if (settings.estimator.stride > 1 && settings.estimator.denoise != Denoise::bilateral)
    fail(ErrorKind::usage, "--stride {} leaves pixels to the denoiser: give --denoise bilateral, or --stride 1", settings.estimator.stride);
  if (settings.input.focal.has_value() != settings.input.aperture.has_value())
    fail(ErrorKind::usage, "--focal and --aperture belong together: focal length and width of the film back in mm");
  if (!settings.input.beauty.empty() && settings.output.composite.empty() && !settings.output.multi_bounce)
    fail(ErrorKind::usage, "--beauty is for a composite: name its file with --composite");
  check_shading(settings);
  const auto outputs = outputs_of(settings.output);
  for (std::size_t i = 0; i < outputs.size(); i++) {
    for (const auto* input : {&settings.input.input, &settings.input.depth, &settings.input.normal, &settings.input.position, &settings.input.beauty,
                              &settings.input.camera, &settings.input.material_ao, &settings.input.albedo})
      if (!input->empty() && same_file(*input, outputs[i].path)) fail(ErrorKind::usage, "{}: {} would overwrite an input", outputs[i].path, outputs[i].option);
    for (std::size_t j = 0; j < i; j++)
      if (same_file(outputs[j].path, outputs[i].path))
        fail(ErrorKind::usage, "{}: {} and {} name the same file", outputs[i].path, outputs[j].option, outputs[i].option);
  }
}

std::string options_digest(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& i = settings.input;
  // Every value on a line of its own, so that no two sets of values make one text.
  std::string text = kVersion;
  const auto add = [&](const auto&... values) { ((text += fmt::format("\n{}", values)), ...); };
  add(int(e.estimator), e.radius ? fmt::format("{}", fmt::join(radii_of(e), ",")) : "", int(e.falloff), e.falloff_start, e.falloff_end, e.slices, e.steps, e.intensity, e.power, e.seed);
  add(e.fade_start.value_or(-1), e.fade_end.value_or(-1), e.roughness, settings.output.fog_density);
  add(settings.output.multi_bounce, i.albedo_value.value_or(-1));
  add(settings.output.aovs, int(settings.output.ao_channels), int(settings.output.aov_space));
  add(i.material_ao.empty(), i.material_ao_channel, i.albedo.empty(), i.albedo_channels);
  add(e.samples, e.bias, int(e.elevation), int(e.sample_kernel), int(e.range_check));
  add(int(e.thickness), e.thickness_length, int(e.resolution), e.stride, int(e.denoise));
  add(e.denoise_radius, fmt::format("{}", fmt::join(e.denoise_kernel, ",")), e.denoise_depth_sigma);
  // The camera by what it says; where files lie is not part of it, so that a job has the same digest wherever its folder is mounted.
  add(i.camera.empty() ? std::string() : read_text(i.camera, "camera", "--camera"));
  add(i.depth_channel, i.normal_channels, i.beauty_channels, i.layer, i.view, i.source);
  add(int(i.depth_kind), i.depth_scale, i.sky, int(i.normal_space), i.fov.value_or(0), i.focal.value_or(0), i.aperture.value_or(0), i.ortho_width.value_or(0));
  const DepthRange& range = i.depth_range;
  add(range.near.value_or(0), range.far.value_or(0), range.reversed, int(range.device), range.log_constant);
  const Region roi = i.roi.value_or(Region{});
  add(roi.x, roi.y, roi.width, roi.height);
  add(int(i.normal_encoding), i.flip_normal.x, i.flip_normal.y, i.flip_normal.z, i.position_channels, int(i.position_space), i.position.empty());
  add(int(settings.output.type));
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

int frame_number_of(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  const std::size_t last = stem.find_last_not_of("0123456789");
  const std::string digits = last == stem.npos ? stem : stem.substr(last + 1);
  return digits.empty() || digits.size() > 9 ? 0 : std::stoi(digits);
}

RunReport run_frames(const Settings& settings) {
  const Stopwatch wall;
  check_settings(settings);
  for (const auto& file : outputs_of(settings.output)) require_writable(file.path, file.option);
  const int threads = settings.device.threads > 0 ? settings.device.threads : int(std::max(1u, std::thread::hardware_concurrency()));
  set_exr_threads(threads);
  if (settings.device.threads > 0) ::setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 1);  // lavapipe's own variable

  std::optional<DisplayTransform> transform;
  if (!settings.output.preview.empty() && !settings.output.composite.empty()) transform.emplace(settings.output.ocio);
  gpu::Device device({settings.device.device, settings.device.require_gpu, settings.device.validate, !settings.device.no_pipeline_cache});
  RunReport report;
  report.device = device.info().name;
  report.options = options_digest(settings);
  gpu::Recorder gpu(device);
  report.frames.push_back(run_frame(device, gpu, settings, transform ? &*transform : nullptr, report.options));
  if (device.info().type == gpu::DeviceType::cpu && settings.device.device == "auto")
    report.frames.back().notes.push_back(fmt::format("no GPU found; computed on {}", device.info().name));
  if (device.validation_messages()) fail(ErrorKind::device, "--validate: the validation layer reported {} messages", device.validation_messages());
  report.wall_s = wall.ms() / 1000;
  if (!settings.output.stats.empty()) write_whole(settings.output.stats, stats_json(report));
  return report;
}

std::string stats_json(const RunReport& report) {
  using Json = nlohmann::ordered_json;
  Json frames = Json::array();
  for (const auto& frame : report.frames) {
    Json passes = Json::array();
    for (const auto& pass : frame.passes) passes.push_back({{"name", pass.name}, {"ms", pass.ms}, {"bytes_read", pass.bytes_read}, {"bytes_written", pass.bytes_written}});
    frames.push_back({{"frame", frame.frame},
                      {"input", frame.input},
                      {"output", frame.output},
                      {"ms", {{"read", frame.read_ms}, {"compute", frame.compute_ms}, {"write", frame.write_ms}, {"total", frame.total_ms}}},
                      {"passes", passes},
                      {"pixels", frame.pixels},
                      {"sky_pixels", frame.sky_pixels},
                      {"samples_per_pixel", frame.samples_per_pixel},
                      {"repaired_pixels", frame.repaired_pixels}});
  }
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  const Json totals = {{"frames", report.frames.size()},
                       {"failed", report.failed},
                       {"wall_s", report.wall_s},
                       {"cpu_s", seconds(usage.ru_utime) + seconds(usage.ru_stime)},
                       {"peak_rss_mb", double(usage.ru_maxrss) / 1024}};
  const Json stats = {{"device", report.device}, {"options", report.options}, {"frames", frames}, {"totals", totals}};
  return stats.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";  // file names need not be UTF-8
}

}  // namespace alcove
