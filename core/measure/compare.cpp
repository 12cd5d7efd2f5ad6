// Files to planes to numbers, frame by frame.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/compare.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "core/base/frame_list.h"
#include "core/base/text.h"
#include "core/formats/picture.h"
#include "core/formats/sequence.h"
#include "core/frame/find/frame_source.h"
#include "core/measure/report.h"

namespace alcove {
namespace {

/// Whether a file of that name exists and can be reached.
bool is_there(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

/// Gives the path's pattern; none if a file of that very name exists.
std::optional<FramePattern> pattern_of(const std::string& path) {
  return is_there(path) ? std::nullopt : frame_pattern(path);
}

/// Pointers to all file names of the settings, which may be empty.
template <class Settings>
auto files_of(Settings& settings) {
  return std::array{&settings.result, &settings.reference, &settings.reference_b,
                    &settings.mask,   &settings.depth,     &settings.motion};
}

CompareSettings settings_of_frame(CompareSettings settings, int frame) {
  settings.name = std::to_string(frame);
  for (auto* path : files_of(settings))
    if (const auto pattern = pattern_of(*path)) *path = pattern->path(frame);
  return settings;
}

/// Gives the frames of the comparison, whether their files are there or not.
std::vector<int> frames_of(const CompareSettings& settings) {
  const auto result = pattern_of(settings.result);
  if (!result)
    fail(ErrorKind::usage,
         "{}: it has no place for a frame number, such as %04d or ####; the other files or --frames ask for a sequence",
         settings.result);
  return settings.frames.empty() ? frames_on_disk(*result, "RESULT") : parse_frames(settings.frames);
}

/// Says of each frame with a missing file which frames of that file are missing.
std::map<int, std::string> missing_frames(const CompareSettings& settings, const std::vector<int>& frames) {
  std::map<int, std::string> sentences;
  for (const std::string* path : files_of(settings)) {
    const auto pattern = pattern_of(*path);
    std::vector<int> missing;
    if (pattern)
      std::ranges::copy_if(frames, std::back_inserter(missing),
                           [&](int frame) { return !is_there(pattern->path(frame)); });
    for (const int frame : missing)
      sentences.try_emplace(frame, fmt::format("{}: frames are missing: {}{}", *path, frames_text(missing),
                                               missing.size() == frames.size() ? why_no_frames(*pattern) : ""));
  }
  return sentences;
}

bool is_sequence(const CompareSettings& settings) {
  return !settings.frames.empty() ||
         std::ranges::any_of(files_of(settings), [](const auto* path) { return pattern_of(*path).has_value(); });
}

/// The pixels that all files of a comparison have.
class CommonWindow {
 public:
  /// Leaves out pixels that this file lacks. Fails if none is left, and if both windows of two files differ, so that
  /// nothing tells which of their pixels belong together.
  void take(const std::string& path, const Window& data, const Window& display) {
    if (first_.empty()) {
      first_ = path;
      data_ = first_data_ = data;
      display_ = display;
    }
    if (data == first_data_) return;
    const auto refuse = [&](const char* why) {
      fail(ErrorKind::input, "{} is {}, and {} is {}: {}", first_, to_string(first_data_), path, to_string(data), why);
    };
    if (display != display_) refuse("their display windows differ too, so they must cover the same pixels");
    data_ = common_part(data_, data);
    if (data_.pixels() == 0) refuse("they share no pixel");
    is_part_ = true;
  }

  const Window& data() const { return data_; }
  /// Whether some file has pixels outside of this window.
  bool is_part() const { return is_part_; }

 private:
  std::string first_;
  Window data_, first_data_, display_;
  bool is_part_ = false;
};

/// The planes of a file.
struct FilePlanes {
  Window data;
  std::vector<float> values;  // empty: no such file

  void cut(const Window& part) {
    if (!values.empty() && data != part) values = cropped(values, data, part);
  }
};

/// The planes of a frame, by their roles.
struct Planes {
  Window data;
  bool is_part = false;                       // some file has pixels outside of this window
  std::vector<std::string> channels;          // names in the result
  std::vector<std::string> ao_channels = {};  // names in the reference, if the name of its layer was all that told them
  Comparable values;
  std::vector<float> depth;  // empty: none
  std::vector<float> motion_x, motion_y;

  std::span<const float> plane(const std::vector<float>& planes, std::size_t index) const {
    return std::span(planes).subspan(index * data.pixels(), data.pixels());
  }
};

FilePlanes read_depth(const CompareSettings& settings, CommonWindow& common) {
  if (settings.depth.empty()) return {};
  InputSettings input;
  input.depth = settings.depth;
  input.depth_channel = settings.depth_channel;
  input.sky = settings.sky;
  input.depth_kind = DepthKind::planar;
  input.fov = 90;  // the search for channels needs a camera, though depth alone does not use one
  input.normal_space = NormalSpace::view;
  FrameSource source = find_frame(input, false, 0);
  common.take(settings.depth, source.reading.data, source.reading.display);
  FilePlanes depth{source.reading.data, std::vector<float>(source.reading.data.pixels())};
  read_planes(source, source.reading.data, {{&source.channels[RawPlane::depth], depth.values.data()}});
  return depth;
}

/// Reads channels of a picture, which have one window.
FilePlanes read_channels(Picture& picture, std::span<const std::size_t> channels, CommonWindow& common) {
  const Window& data = picture.channels()[channels[0]].data;
  common.take(picture.path(), data, picture.display());
  return {data, picture.read(channels)};
}

std::size_t mask_channel_of(const Picture& picture, const std::string& chosen) {
  if (!chosen.empty()) return picture.find(chosen, "--mask-channel");
  if (picture.channels().size() == 1) return 0;
  for (std::size_t i = 0; i < picture.channels().size(); i++) {
    const std::string name = lower_case(picture.channels()[i].name);
    if (name == "a" || name == "alpha" || name.ends_with(".a") || name.ends_with(".alpha")) return i;
  }
  fail(ErrorKind::input, "{}: its mask channel is not clear: there is {}; choose with --mask-channel", picture.path(),
       list_of(picture.names()));
}

FilePlanes read_mask(const CompareSettings& settings, CommonWindow& common) {
  if (settings.mask.empty()) return {};
  Picture picture(settings.mask, "--mask");
  return read_channels(picture, std::array{mask_channel_of(picture, settings.mask_channel)}, common);
}

/// Marks the pixels to compare, by the mask's values and the depth's sky; empty: all.
std::vector<std::uint8_t> mask_of(const CompareSettings& settings, const std::vector<float>& values, Values depth) {
  std::vector<std::uint8_t> mask = surfaces(depth, settings.sky);
  if (values.empty()) return mask;
  if (mask.empty()) mask.assign(values.size(), 1);
  for (std::size_t i = 0; i < mask.size(); i++) mask[i] = mask[i] && values[i] > 0;
  return mask;
}

FilePlanes read_motion(const CompareSettings& settings, CommonWindow& common) {
  if (settings.motion.empty()) return {};
  Picture picture(settings.motion, "--motion");
  const std::string names = settings.motion_channels.empty() ? "Vector.X,Vector.Y" : settings.motion_channels;
  const std::size_t comma = names.find(',');
  if (comma == names.npos) fail(ErrorKind::usage, "--motion-channels {}: give two names, X,Y", names);
  const std::array channels{picture.find(names.substr(0, comma), "--motion-channels"),
                            picture.find(names.substr(comma + 1), "--motion-channels")};
  return read_channels(picture, channels, common);
}

Planes read_planes_of(const CompareSettings& settings) {
  Picture result(settings.result, "RESULT"), reference(settings.reference, "REFERENCE");
  const auto [pairs, by_ao_layer] = match_channels(result, reference, settings.channels);
  std::vector<std::size_t> of_result, of_reference;
  Planes planes;
  for (const auto& pair : pairs) {
    of_result.push_back(pair.result);
    of_reference.push_back(pair.reference);
    planes.channels.push_back(result.channels()[pair.result].name);
    if (by_ao_layer) planes.ao_channels.push_back(reference.channels()[pair.reference].name);
  }
  CommonWindow common;
  FilePlanes results = read_channels(result, of_result, common),
             references = read_channels(reference, of_reference, common);
  FilePlanes references_b;
  if (!settings.reference_b.empty()) {
    Picture second(settings.reference_b, "--reference-b");
    std::vector<std::size_t> of_second;
    for (const std::size_t channel : of_reference)
      of_second.push_back(second.find(reference.channels()[channel].name, "--reference-b"));
    references_b = read_channels(second, of_second, common);
  }
  FilePlanes depth = read_depth(settings, common), mask = read_mask(settings, common);
  FilePlanes motion = read_motion(settings, common);
  planes.data = common.data();
  planes.is_part = common.is_part();
  for (auto* file : {&results, &references, &references_b, &depth, &mask, &motion}) file->cut(planes.data);
  planes.depth = std::move(depth.values);
  planes.values = make_comparable(fmt::format("{} against {}", settings.result, settings.reference),
                                  planes.data.pixels(), results.values, references.values, references_b.values,
                                  mask_of(settings, mask.values, planes.depth));
  if (!motion.values.empty()) {
    const auto middle = motion.values.begin() + std::ptrdiff_t(planes.data.pixels());
    planes.motion_x.assign(motion.values.begin(), middle);
    planes.motion_y.assign(middle, motion.values.end());
  }
  return planes;
}

using Color = std::array<std::size_t, 3>;

/// The indices of red, green and blue of every layer that has them.
std::vector<Color> color_layers(const std::vector<std::string>& names) {
  const auto index = [&](const std::string& name) {
    const auto found = std::ranges::find_if(names, [&](const std::string& other) { return lower_case(other) == name; });
    return std::size_t(found - names.begin());
  };
  std::vector<Color> colors;
  for (std::size_t red = 0; red < names.size(); red++) {
    const std::string name = lower_case(names[red]), layer = name.substr(0, name.rfind('.') + 1);  // npos + 1 is 0
    const Color color{red, index(layer + "g"), index(layer + "b")};
    if (name == layer + "r" && std::ranges::max(color) < names.size()) colors.push_back(color);
  }
  return colors;
}

/// The mean FLIP of the colours of every layer; without colours, of every channel as grey.
double mean_flip(const Planes& planes, const std::vector<float>& reference, bool hdr) {
  double sum = 0;
  std::size_t count = 0;
  const auto add = [&](const Color& channels) {
    ColorPlanes a, b;
    for (std::size_t c = 0; c < 3; c++) {
      a[c] = planes.plane(planes.values.result, channels[c]);
      b[c] = planes.plane(reference, channels[c]);
    }
    const auto map = (hdr ? hdr_flip : ldr_flip)(planes.data.width, planes.data.height, a, b);
    for (std::size_t i = 0; i < map.size(); i++)
      if (planes.values.mask[i]) {
        sum += map[i];
        count++;
      }
  };
  const auto colors = color_layers(planes.channels);
  for (const auto& color : colors) add(color);
  for (std::size_t c = 0; c < planes.channels.size() && colors.empty(); c++) add({c, c, c});
  return sum / double(count);
}

double srgb_from_linear(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

/// Makes the pictures: the first layer's colours, or without colours the first channel as grey. Scene-linear values are
/// shown as a display would.
ComparePictures pictures_of(const Planes& planes, const std::vector<float>& reference, bool hdr) {
  const auto colors = color_layers(planes.channels);
  const std::size_t channels = colors.empty() ? 1 : 3;
  const auto shown = [&](float x) { return hdr ? float(srgb_from_linear(x)) : x; };
  const auto picture = [&](const std::vector<float>& values) {
    std::vector<float> pixels;
    for (std::size_t i = 0; i < planes.data.pixels(); i++)
      for (std::size_t c = 0; c < channels; c++)
        pixels.push_back(shown(planes.plane(values, colors.empty() ? 0 : colors[0][c])[i]));
    return picture_url(planes.data.width, planes.data.height, int(channels), pixels);
  };
  return {picture(planes.values.result), picture(reference)};
}

/// The error that has full colour: 1, 2.5 or 5 times a power of ten that few errors exceed, and none by more than four
/// times, so that neither a small error is white nor one pixel hides all others.
float scale_for(const PlaneErrors& errors) {
  const double most = std::max(errors.p99, 0.25 * errors.max);
  if (!(most > 0)) return kFullColorError;
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {1.0, 2.5, 5.0})
    if (most <= step * power) return float(step * power);
  return float(10 * power);
}

/// The error as the mean over the channels, in colours.
std::string error_png_of(const Planes& planes, const std::vector<float>& reference, float scale) {
  const auto mean = [&](const std::vector<float>& values) {
    std::vector<float> pixels(planes.data.pixels());
    for (std::size_t i = 0; i < values.size(); i++)
      pixels[i % pixels.size()] += values[i] / float(planes.channels.size());
    return pixels;
  };
  return error_png(planes.data.width, planes.data.height, mean(planes.values.result), mean(reference), scale);
}

/// Adds the measures that need depth: edges and plain surfaces.
void measure_by_depth(FrameComparison& c, const Planes& planes, double sky) {
  const auto& values = planes.values;
  const int width = planes.data.width, height = planes.data.height;
  c.edges = edge_errors(depth_edges(width, height, planes.depth, sky), values.result, values.reference, values.mask,
                        values.reference_b);
  c.grain = grain(width, height, plain_pixels(width, height, planes.depth, sky, values.mask), values.result,
                  values.reference, values.reference_b);
}

/// The share of all pixels from which pixels of 0 and 1 count as sky, and the share of the squared error that they must
/// make. In AO without sky, next to nothing is exactly 0 in one picture and exactly 1 in the other.
constexpr double kSkyShare = 0.001, kSkyErrorShare = 0.1;

/// The pixels whose values are all `low` in the result and all 1 - `low` in the reference.
std::vector<std::uint8_t> opposite_pixels(const Planes& planes, float low) {
  const auto& values = planes.values;
  const std::size_t pixels = planes.data.pixels();
  std::vector<std::uint8_t> opposite = values.mask;
  for (std::size_t i = 0; i < values.result.size(); i++)
    if (values.result[i] != low || values.reference[i] != 1 - low) opposite[i % pixels] = 0;
  return opposite;
}

std::optional<SkyDifference> sky_difference(const Planes& planes, double rmse) {
  const auto& values = planes.values;
  for (const float low : {0.0f, 1.0f}) {
    const auto sky = opposite_pixels(planes, low);
    const auto count = std::size_t(std::ranges::count(sky, 1));
    const bool matters = double(count) >= kSkyErrorShare * rmse * rmse * double(values.count);
    if (double(count) < kSkyShare * double(values.count) || !matters || count == values.count) continue;
    std::vector<std::uint8_t> others = values.mask;
    for (std::size_t i = 0; i < others.size(); i++) others[i] = others[i] && !sky[i];
    return SkyDifference{count, low == 0,
                         compare_planes(values.result, values.reference, others, values.reference_b).rmse};
  }
  return {};
}

HoleAt hole_at(const Planes& planes, const Hole& hole) {
  const std::size_t pixel = hole.value % planes.data.pixels(), width = std::size_t(planes.data.width);
  return {planes.data.x + int(pixel % width), planes.data.y + int(pixel / width),
          planes.channels[hole.value / planes.data.pixels()], hole.in_result};
}

FrameComparison measure(const CompareSettings& settings, const Planes& planes, int frame) {
  const auto& values = planes.values;
  const int width = planes.data.width, height = planes.data.height;
  const auto reference = values.mean_reference();
  FrameComparison c;
  c.frame = frame;
  c.name = name_of(settings);
  c.limits = settings.limits;
  c.result = settings.result;
  c.reference = settings.reference;
  c.channels = planes.channels;
  c.ao_channels = planes.ao_channels;
  c.width = width;
  c.height = height;
  if (planes.is_part) c.common = planes.data;
  c.count = values.count;
  c.excluded = values.excluded;
  c.masked = values.masked;
  c.holes = values.holes;
  if (values.first_hole) c.first_hole = hole_at(planes, *values.first_hole);
  c.errors = compare_planes(values.result, values.reference, values.mask, values.reference_b);
  c.sky_differs = sky_difference(planes, c.errors.rmse);
  c.psnr = psnr(c.errors.rmse, settings.peak);
  c.ssim = ssim(width, height, values.result, reference, values.mask, settings.peak);
  c.flip = mean_flip(planes, reference, settings.hdr);
  c.bands = darkness_bands(values.result, values.reference, values.mask, values.reference_b);
  if (!planes.depth.empty()) measure_by_depth(c, planes, settings.sky);
  c.error_scale = scale_for(c.errors);
  if (settings.pictures) c.pictures = pictures_of(planes, reference, settings.hdr);
  if (settings.pictures || (settings.failures && is_broken(c)))
    c.error_png = error_png_of(planes, reference, c.error_scale);
  return c;
}

ErrorFrame error_frame(Planes planes) {
  const auto difference = [&](const std::vector<float>& reference) {
    std::vector<float> error(reference.size());
    std::ranges::transform(planes.values.result, reference, error.begin(), std::minus());
    return error;
  };
  ErrorFrame frame;
  frame.width = planes.data.width;
  frame.height = planes.data.height;
  frame.error = difference(planes.values.reference);
  if (!planes.values.reference_b.empty()) frame.error_b = difference(planes.values.reference_b);
  frame.mask = std::move(planes.values.mask);
  frame.depth = std::move(planes.depth);
  frame.motion_x = std::move(planes.motion_x);
  frame.motion_y = std::move(planes.motion_y);
  return frame;
}

/// The number of a frame of a sequence, else 0.
int number_of(const CompareReport& report, const CompareSettings& here) {
  return report.is_sequence ? std::stoi(here.name) : 0;
}

/// Drops the pictures of the frame with the least error when there are too many; but that of a failure if those are
/// wanted.
void limit_pictures(std::vector<FrameComparison>& frames, bool keeps_failures) {
  std::vector<FrameComparison*> pictured;
  for (auto& frame : frames)
    if (frame.pictures) pictured.push_back(&frame);
  if (pictured.size() <= kMostPicturedFrames) return;
  FrameComparison& least = **std::ranges::min_element(pictured, {}, [](auto* frame) { return frame->errors.rmse; });
  least.pictures.reset();
  if (!keeps_failures || !is_broken(least)) least.error_png.clear();
}

/// The planes of a frame; none where they cannot be compared, which the report then says. `missing`: the sentences of
/// frames that lack a file.
std::optional<Planes> planes_or_failure(CompareReport& report, const CompareSettings& here,
                                        const std::map<int, std::string>& missing) {
  try {
    if (const auto sentence = missing.find(number_of(report, here)); sentence != missing.end())
      fail(ErrorKind::input, "{}", sentence->second);
    if (report.is_list && here.reference.empty())
      fail(ErrorKind::input, "{}: frame {} has neither \"reference\" nor \"truth\"", report.reference, here.name);
    return read_planes_of(here);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    report.failed.push_back({name_of(here), error.what()});
    return std::nullopt;
  }
}

/// The settings of each frame of a list; "" is the reference of one that has none.
std::vector<CompareSettings> settings_of_list(const CompareSettings& settings) {
  const auto frames = read_frame_list(settings.reference, "REFERENCE");
  if (frames.size() > 1 && settings.result.find(kNamePlace) == settings.result.npos)
    fail(ErrorKind::usage, "{}: {}", settings.result, why_no_place(settings.reference));
  std::vector<CompareSettings> all;
  for (const auto& frame : frames) {
    CompareSettings& here = all.emplace_back(settings);
    for (auto* path : files_of(here)) *path = with_name(*path, frame.name);
    const auto& references = frame.compared_with();
    here.name = frame.name;
    here.reference = references.empty() ? "" : references.front();
    if (references.size() > 1) here.reference_b = references.back();
    here.limits = with_limits(settings.limits, frame.limits);
  }
  return all;
}

}  // namespace

std::vector<CompareSettings> settings_of_frames(const CompareSettings& settings) {
  if (is_frame_list(settings.reference)) return settings_of_list(settings);
  if (!is_sequence(settings)) return {settings};
  std::vector<CompareSettings> all;
  for (const int frame : frames_of(settings)) all.push_back(settings_of_frame(settings, frame));
  return all;
}

std::string name_of(const CompareSettings& of_frame) {
  return of_frame.name.empty() ? std::filesystem::path(of_frame.reference).filename().string() : of_frame.name;
}

CompareReport compare_pictures(const CompareSettings& settings) {
  CompareReport report{
      .result = settings.result, .reference = settings.reference, .is_list = is_frame_list(settings.reference)};
  report.is_sequence = !report.is_list && is_sequence(settings);
  if (!report.has_several() && !settings.motion.empty())
    fail(ErrorKind::usage, "--motion {}: it is for the flicker of a sequence, and RESULT is one picture",
         settings.motion);
  std::map<int, std::string> missing;
  if (report.is_sequence) missing = missing_frames(settings, frames_of(settings));
  Flicker flicker;
  std::optional<ErrorFrame> previous;
  for (const auto& here : settings_of_frames(settings)) {
    auto planes = planes_or_failure(report, here, missing);
    if (!planes) continue;
    const int frame = number_of(report, here);
    const bool follows = previous && report.frames.back().frame == frame - 1;
    report.frames.push_back(measure(here, *planes, frame));
    limit_pictures(report.frames, settings.failures);
    if (!report.is_sequence) continue;
    ErrorFrame errors = error_frame(std::move(*planes));
    if (follows && previous->error.size() == errors.error.size() && previous->width == errors.width)
      flicker.add(*previous, errors);
    previous = std::move(errors);
  }
  if (flicker.count()) report.flicker = flicker.rms();
  return report;
}

namespace {

/// The note on what names alone have paired.
Notes notes_on_channels(const CompareReport& report) {
  Notes notes;
  for (const auto& frame : report.frames)
    if (!frame.ao_channels.empty())
      add_new(notes,
              {{NoteCode::ao_layer, fmt::format("{} against {} of the reference, by the name; --channel chooses others",
                                                fmt::join(frame.channels, ", "), fmt::join(frame.ao_channels, ", "))}});
  return notes;
}

Notes warnings_on_sky(const CompareReport& report, const CompareSettings& settings) {
  const auto pixels = [](const FrameComparison& frame) { return frame.sky_differs ? frame.sky_differs->count : 0; };
  const FrameComparison& frame = *std::ranges::max_element(report.frames, {}, pixels);
  if (!frame.sky_differs) return {};
  const SkyDifference& sky = *frame.sky_differs;
  const auto& [zero, one] =
      sky.zero_in_result ? std::pair(frame.result, frame.reference) : std::pair(frame.reference, frame.result);
  return {
      {NoteCode::sky_differs,
       fmt::format(
           "{:.1f} % of the pixels are 0 in {} and 1 in {}, perhaps sky; without them rmse is {:.4f}, not {:.4f}: {}",
           100 * double(sky.count) / double(frame.count), zero, one, sky.rmse_without, frame.errors.rmse,
           settings.depth.empty() ? "--depth FRAME.exr leaves the sky out, --mask FILE any pixels"
                                  : "--sky VALUE says from which depth on pixels are sky")}};
}

/// The numbers between the frames of RESULT, and those that REFERENCE has beside them.
std::vector<int> frames_left_out(const CompareReport& report, const CompareSettings& settings) {
  std::vector<int> compared;
  std::ranges::transform(report.frames, std::back_inserter(compared), &FrameComparison::frame);
  for (const auto& failed : report.failed) compared.push_back(std::stoi(failed.name));
  std::ranges::sort(compared);
  std::set<int> all(compared.begin(), compared.end());
  for (const int frame : holes_in(compared)) all.insert(frame);
  if (const auto pattern = pattern_of(settings.reference))
    for (const int frame : frames_on_disk(*pattern, "REFERENCE")) all.insert(frame);
  std::vector<int> left_out;
  std::ranges::set_difference(all, compared, std::back_inserter(left_out));
  return left_out;
}

Notes notes_on_frames(const CompareReport& report, const CompareSettings& settings) {
  if (!report.is_sequence || !settings.frames.empty()) return {};
  const std::vector<int> left_out = frames_left_out(report, settings);
  if (left_out.empty()) return {};
  return {{NoteCode::sequence_hole, fmt::format("{}: missing frames were not compared: {}; --frames lists the frames",
                                                settings.result, frames_text(left_out))}};
}

}  // namespace

Notes notes_on(const CompareReport& report, const CompareSettings& settings) {
  Notes notes = notes_on_frames(report, settings);
  add_new(notes, notes_on_channels(report));
  add_new(notes, warnings_on_sky(report, settings));
  const std::string holes = holes_beyond(report, 0);
  if (!has_limits(report) && !holes.empty())
    notes.push_back({NoteCode::holes, holes + "; with any limit, such as --max-rmse, the exit code would be 6"});
  return notes;
}

const FrameComparison& worst_frame(const CompareReport& report) {
  return *std::ranges::max_element(report.frames, {}, [](const auto& frame) { return frame.errors.rmse; });
}

}  // namespace alcove
