// Options, planes of any layout and camera -> a reading -> the chain -> results.
// SPDX-License-Identifier: BSD-3-Clause
#include "api/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/half.h"
#include "core/base/text.h"
#include "core/frame/pixels/findings.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/radius.h"
#include "core/frame/pixels/ramps.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/normal_settlement.h"
#include "core/frame/settle/settlement.h"

namespace alcove {
namespace {

// The caller's planes, of any layout, and ours, one component behind the other.

constexpr int kMostSide = 1 << 24, kMostComponents = 64;
// Bytes. By the largest side, and three times that, it is a ptrdiff_t still.
constexpr std::ptrdiff_t kMostStride = std::numeric_limits<std::ptrdiff_t>::max() / kMostSide / 4;

std::size_t bytes_of(int type) { return type == ALCOVE_HALF ? 2 : 4; }

struct Strides {
  std::ptrdiff_t pixel, row, component;
};

Strides strides_of(const alcove_layout& layout) {
  const auto bytes = std::ptrdiff_t(bytes_of(layout.type));
  Strides strides{layout.pixel_stride, layout.row_stride, layout.component_stride ? layout.component_stride : bytes};
  if (!strides.pixel) strides.pixel = bytes * layout.components;
  if (!strides.row) strides.row = strides.pixel * layout.width;
  return strides;
}

/// Calls use(place, byte, stride) for each row of each component, in our order.
template <class Byte, class Use>
void for_rows(Byte* data, const alcove_layout& layout, const Use& use) {
  const Strides strides = strides_of(layout);
  std::size_t place = 0;
  for (int c = 0; c < layout.components; c++)
    for (int y = 0; y < layout.height; y++, place += std::size_t(layout.width))
      use(place, data + c * strides.component + y * strides.row, strides.pixel);
}

/// Checks a layout. Fails with ErrorKind::usage, naming the plane, on no pixels or too many, no components, an unknown
/// type, or strides by which values share bytes.
void check_layout(const std::string& name, const alcove_layout& layout) {
  if (layout.width < 1 || layout.height < 1 || layout.width > kMostSide || layout.height > kMostSide)
    fail(ErrorKind::usage, "{}: a plane of {} x {} pixels", name, layout.width, layout.height);
  if (layout.components < 1 || layout.components > kMostComponents)
    fail(ErrorKind::usage, "{}: a plane of {} components", name, layout.components);
  constexpr std::int64_t kMostValues = std::int64_t(1) << 32;  // more than a buffer of any device holds
  if (std::int64_t(layout.width) * layout.height > kMostValues / layout.components)
    fail(ErrorKind::usage, "{}: a plane of {} x {} x {} values, more than any device takes", name, layout.width,
         layout.height, layout.components);
  if (layout.type != ALCOVE_FLOAT && layout.type != ALCOVE_HALF)
    fail(ErrorKind::usage, "{}: a plane of type {}, which is neither ALCOVE_FLOAT nor ALCOVE_HALF", name, layout.type);
  const auto is_endless = [](std::ptrdiff_t stride) { return stride < -kMostStride || stride > kMostStride; };
  if (is_endless(layout.component_stride) || is_endless(layout.pixel_stride) || is_endless(strides_of(layout).row))
    fail(ErrorKind::usage,
         "{}: strides of {}, {} and {} bytes from component, pixel and row to the next: beyond memory", name,
         layout.component_stride, layout.pixel_stride, layout.row_stride);
  // From the shortest stride on, each must reach beyond all that lies within it.
  const Strides strides = strides_of(layout);
  std::array<std::pair<std::int64_t, int>, 3> steps{
      std::pair<std::int64_t, int>{std::abs(strides.component), layout.components},
      {std::abs(strides.pixel), layout.width},
      {std::abs(strides.row), layout.height}};
  std::ranges::sort(steps);
  auto extent = std::int64_t(bytes_of(layout.type));
  for (const auto& [stride, count] : steps) {
    if (count > 1 && stride < extent)
      fail(ErrorKind::usage, "{}: a stride of {} bytes over values of {} bytes: strides are in bytes, 0 is packed",
           name, stride, extent);
    extent += stride * (count - 1);
  }
}

/// Copies the caller's values. The layout must have been checked.
std::vector<float> planes_from(const void* data, const alcove_layout& layout) {
  const auto width = std::size_t(layout.width);
  std::vector<float> planes(width * std::size_t(layout.height) * std::size_t(layout.components));
  for_rows(static_cast<const std::byte*>(data), layout,
           [&](std::size_t place, const std::byte* from, std::ptrdiff_t stride) {
             for (std::size_t x = 0; x < width; x++) {
               const std::byte* const at = from + std::ptrdiff_t(x) * stride;
               std::uint16_t half = 0;
               if (layout.type == ALCOVE_FLOAT)
                 std::memcpy(&planes[place + x], at, sizeof(float));
               else
                 std::memcpy(&half, at, sizeof half), planes[place + x] = from_half(half);
             }
           });
  return planes;
}

/// Copies as many planes as the layout has components into the caller's memory; half floats are rounded to the nearest,
/// to even.
void planes_to(std::span<const float> planes, void* data, const alcove_layout& layout) {
  const auto width = std::size_t(layout.width);
  for_rows(static_cast<std::byte*>(data), layout, [&](std::size_t place, std::byte* to, std::ptrdiff_t stride) {
    for (std::size_t x = 0; x < width; x++) {
      std::byte* const at = to + std::ptrdiff_t(x) * stride;
      const float value = planes[place + x];
      const std::uint16_t half = layout.type == ALCOVE_FLOAT ? std::uint16_t(0) : to_half(value);
      if (layout.type == ALCOVE_FLOAT)
        std::memcpy(at, &value, sizeof value);
      else
        std::memcpy(at, &half, sizeof half);
    }
  });
}

// Names.

/// Values in 0 to 1 throughout are 0.5 + 0.5 n, as they are where frames are read from files.
bool is_unorm(const std::vector<float>& values) {
  return std::ranges::all_of(values, [](float x) { return !std::isfinite(x) || (x >= 0 && x <= 1); });
}

template <class T>
T decided(T said, T by_camera, T otherwise) {
  return said != T::automatic ? said : by_camera != T::automatic ? by_camera : otherwise;
}

/// A plane that a caller may give.
struct PlaneFacts {
  const char* name;
  int least, most;  // components
  RawPlane plane;
  std::string InputSettings::*file;  // that the program has in its place; null: one of a list
};
constexpr PlaneFacts kPlanes[] = {
    {"depth", 1, 1, RawPlane::depth, &InputSettings::depth},
    {"position", 3, 3, RawPlane::depth, &InputSettings::position},
    {"normal", 2, 3, RawPlane::normal, &InputSettings::normal},
    {"behind", 1, 1, RawPlane::behind, nullptr},
    {"material-ao", 1, 1, RawPlane::material_ao, &InputSettings::material_ao},
    {"matte", 1, 1, RawPlane::matte, &InputSettings::matte},
    {"occluders", 1, 1, RawPlane::occluders, &InputSettings::occluders},
    {"ignore", 1, 1, RawPlane::occluders, &InputSettings::ignore},
    {"albedo", 3, 3, RawPlane::albedo, &InputSettings::albedo},
};

bool is_plane(std::string_view name) {
  return std::ranges::find(kPlanes, name, &PlaneFacts::name) != std::end(kPlanes);
}

const PlaneFacts& facts_of_plane(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& facts : kPlanes) {
    if (name == facts.name) return facts;
    names.emplace_back(facts.name);
  }
  fail(ErrorKind::usage, "there is no plane {}{}; there is {}", name, suggestion(name, names), list_of(names));
}

/// The row of a setting that the library takes, with or without two dashes.
const SettingRow& row_of(const std::string& option) {
  const std::string key = option.starts_with("--") ? option.substr(2) : option;
  std::vector<std::string> keys;
  for (const auto& row : option_table())
    if (row.in_library) keys.push_back(row.key());
  const auto row = std::ranges::find(option_table(), key, &SettingRow::key);
  if (row == option_table().end()) fail(ErrorKind::usage, "there is no option {}{}", key, suggestion(key, keys));
  if (row->in_library) return *row;
  if (is_plane(key)) fail(ErrorKind::usage, "{} is a plane: alcove_plane() takes it", key);
  if (key == "camera" || key == "preset") fail(ErrorKind::usage, "{} is no option: alcove_{}() takes it", key, key);
  fail(ErrorKind::usage, "{} is not available in the library", key);
}

// Sentences of the core, which call an option --KEY or --set KEY=VALUE, in the library's words.

/// An option in a sentence.
struct Mention {
  std::size_t size;   // of the sentence's own spelling
  std::string words;  // the library's
};

bool is_parameter(const SettingRow& row) {
  return row.in_library || is_plane(row.key()) || row.key() == "camera" || row.key() == "preset";
}

/// The option that `text` begins with. Other words with dashes are the caller's own.
std::optional<Mention> mention_at(std::string_view text) {
  constexpr std::string_view kOption = "--", kSet = "--set ", kOfKeys = "abcdefghijklmnopqrstuvwxyz-";
  if (!text.starts_with(kOption)) return std::nullopt;
  std::string_view rest = text.substr((text.starts_with(kSet) ? kSet : kOption).size());
  const std::string_view key = rest.substr(0, rest.find_first_not_of(kOfKeys));
  const auto row = std::ranges::find(option_table(), key, &SettingRow::key);
  if (row == option_table().end()) return std::nullopt;
  rest.remove_prefix(key.size());
  const bool has_value = rest.starts_with('=');
  return Mention{text.size() - rest.size() + has_value,
                 fmt::format("'{}'{}{}", key, is_parameter(*row) ? "" : " (not in the library)", has_value ? " " : "")};
}

// The pixels are asked, as for frames from files; nothing is guessed, since whoever has planes knows what they are.

constexpr double kUnit = 0.9, kFew = 0.5;  // shares of normals of unit length that tell an encoding
constexpr std::size_t kStep = 16;          // one pixel of so many is looked at

/// Refuses values that are no depth of their kind at all.
void check_depth(const Reading& reading, std::span<const float> depth) {
  const auto is_surface = [&](float z) { return z > 0 && z < reading.sky; };
  const auto is_negative = [](float z) { return std::isfinite(z) && z < 0; };
  if (is_distance(reading.depth_kind) && std::ranges::none_of(depth, is_surface) &&
      std::ranges::any_of(depth, is_negative))
    fail(ErrorKind::input, "depth: all surfaces have negative values: distances are positive, so give -depth");
  const auto is_fraction = [](float z) { return z > -1 && z < 1 && z != 0; };
  const auto is_beyond = [](float z) { return std::isfinite(z) && z > 1; };
  if (is_between_planes(reading.depth_kind) && std::ranges::none_of(depth, is_fraction) &&
      std::ranges::any_of(depth, is_beyond))
    fail(ErrorKind::input,
         "depth: {} depth lies within 0 to 1, and no value does: divide integers by their largest one",
         word_of(reading.depth_kind));
}

std::string text_of(const NormalScore& score) {
  const std::string flips = to_string(score.flips);
  return fmt::format("--normal-space {}{} ({:.0f} % agree)", word_of(score.space),
                     flips == "none" ? "" : " with --flip-normal " + flips, 100 * score.agreement);
}

void check_normals(const Reading& reading, const HostPlanes& planes, Notes& notes) {
  const auto normal = planes[RawPlane::normal], depth = planes[RawPlane::depth];
  const DepthMap map = depth_map_of(reading);
  const bool has_vectors = normal.size() == 3 * reading.data.pixels() &&
                           reading.normal_encoding != NormalEncoding::octahedral &&
                           reading.normal_encoding != NormalEncoding::spheremap;
  const NormalStatistics lengths = normal_statistics(normal, depth, map, kStep);
  if (has_vectors && !reading.normal_unorm && lengths.unorm_unit_share > kUnit && lengths.unit_share < kFew)
    fail(ErrorKind::input, "normal: 2 n - 1 is of unit length on {:.0f} %, and n is not: set --normal-encoding unorm",
         100 * lengths.unorm_unit_share);
  if (has_vectors && reading.normal_unorm && lengths.unit_share > kUnit && lengths.unorm_unit_share < kFew)
    fail(ErrorKind::input, "normal: n is of unit length on {:.0f} %, and 2 n - 1 is not: set --normal-encoding signed",
         100 * lengths.unit_share);
  if (lacks_sign(normal.size() / reading.data.pixels(), reading.normal_encoding) &&
      reading.normal_space == NormalSpace::world)
    fail(ErrorKind::input,
         "normal: two components do not tell the sign of z in world space: give three, or set --normal-space view, or "
         "--normal-encoding octahedral or spheremap");
  const auto scores = score_normals({reading, normal, depth});
  const NormalScore* chosen = score_of(scores, reading.normal_space, reading.flip_normal);
  if (!chosen || chosen->agreement >= kLeastAgreement) return;
  const std::string said =
      fmt::format("normal: {:.0f} % agree with depth, in {} space", 100 * chosen->agreement, word_of(chosen->space));
  if (scores[0].clearly_beats(*chosen)) fail(ErrorKind::input, "{}; better fits {}", said, text_of(scores[0]));
  const auto turned = best_turned_camera({reading, normal, depth}, *chosen);
  if (turned && turned->score.clearly_beats(*chosen))
    fail(ErrorKind::input, "{}; {}, then {:.0f} % agree", said, turned->what, 100 * turned->score.agreement);
  const std::string check = "check --normal-space, --normal-encoding and the camera";
  if (chosen->explained() < kUsable && !reading.depth_is_half)
    fail(ErrorKind::input, "{}, and no more in another space: {}; without the plane, normals are those of depth", said,
         check);
  notes.push_back({NoteCode::normals_disagree, said + ": " + check});
}

/// Looks at the pixels as at those of files, and takes down in `reading` what they show. Fails with ErrorKind::input if
/// depth cannot be of its kind or is too coarse for AO, if positions do not lie on the rays of their pixels, and if the
/// normals, by their reading, are not those of the depth; with ErrorKind::usage on options that have no effect on depth
/// of its kind. Gives sentences about doubts.
Notes check_planes(Reading& reading, const HostPlanes& planes, const InputSettings& settings) {
  const auto depth = planes[RawPlane::depth], normal = planes[RawPlane::normal];
  const std::string name = reading.depth_kind == DepthKind::position ? "position" : "depth";
  check_depth(reading, depth);
  const RawPart raw{reading.data, depth, normal};
  Notes notes;
  Evidence seen;
  DepthFacts said;
  said.program.rules = &input_rules("generic");
  said.said_by = "--depth-kind, the camera or default";
  seen.grain = measure_rounding(reading, raw.window, depth, name);
  settle_depth({reading, notes, settings, raw, seen, name}, said);
  // Coarse disparity has been held against them for its shift, which is all that it can tell.
  if (!normal.empty() && !seen.space_by_shift) check_normals(reading, planes, notes);
  add_new(notes, detected(findings_of(reading, raw, seen, name, true)));
  measure_levels(reading, depth);
  return notes;
}

/// Gives sentences about radii that do not suit the depth.
Notes check_radius(const Reading& reading, std::span<const float> depth, const EstimatorSettings& settings) {
  if (!settings.radius) return {};
  DepthSample sample;
  sample.add(view_of(reading, reading.data), depth_map_of(reading), depth_precision_of(reading), depth);
  const auto radii = radii_of(settings);
  return sample.notes(radii.front(), radii.back(), reading.data.width, reading.data.height);
}

}  // namespace

std::string in_library_words(std::string_view sentence) {
  std::string text;
  while (!sentence.empty()) {
    const auto mention = mention_at(sentence);
    text += mention ? mention->words : std::string(1, sentence.front());
    sentence.remove_prefix(mention ? mention->size : 1);
  }
  return text;
}

void Session::set(const std::string& option, const char* value) {
  const SettingRow& row = row_of(option);
  Settings read;
  if (value) row.read(read, {value});
  if (value && row.key() == "albedo" && !read.input.albedo_value)
    fail(ErrorKind::usage, "{}: {} is no number from 0 to 1; colours are the plane albedo", row.long_name(),
         visible(value));
  std::erase_if(values_, [&](const OptionValue& other) { return other.row == &row; });
  if (value) values_.push_back({&row, {value}});
}

void Session::preset(const char* name) {
  if (!name) return presets_.clear();
  std::vector<std::string> names;
  for (const auto& [known, text] : preset_texts()) {
    if (lower_case(known) == lower_case(name)) return presets_.push_back({known, text});
    names.push_back(known);
  }
  fail(ErrorKind::usage, "there is no preset {}{}; there is {}", name, suggestion(name, names), list_of(names));
}

void Session::plane(const std::string& name, const void* data, const alcove_layout* layout) {
  const PlaneFacts& facts = facts_of_plane(name);
  Planes& planes = planes_[name];
  if (!data) return planes.clear();
  if (!layout) fail(ErrorKind::usage, "{}: a plane without a layout", name);
  check_layout(name, *layout);
  if (layout->components < facts.least || layout->components > facts.most)
    fail(ErrorKind::usage, "{}: {} components, where {} belong", name, layout->components,
         facts.least == facts.most ? fmt::format("{}", facts.least) : fmt::format("{} or {}", facts.least, facts.most));
  if (planes.size() == kMostBehind) fail(ErrorKind::usage, "behind: more than {} planes", kMostBehind);
  Given given{layout->width, layout->height, layout->type == ALCOVE_HALF, planes_from(data, *layout)};
  if (name != "behind") planes.clear();
  planes.push_back(std::move(given));
}

const Session::Planes& Session::given(const std::string& name) const {
  static const Planes kNone;
  const auto planes = planes_.find(name);
  return planes == planes_.end() ? kNone : planes->second;
}

void Session::camera(const std::array<double, 4>& projection, const double* world_to_camera) {
  std::vector<double> numbers(projection.begin(), projection.end());
  if (world_to_camera) numbers.insert(numbers.end(), world_to_camera, world_to_camera + 16);
  if (!std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }))
    fail(ErrorKind::input, "a camera with a number that is infinite or NaN");
  pinhole_ = numbers;
  camera_json_.reset();
}

void Session::camera_json(const char* text) {
  std::optional<std::string> given;
  if (text) given = text;
  pinhole_.clear();
  camera_json_ = std::move(given);
}

const Session::Given& Session::depth() const {
  const Planes& planes = given(has_position() ? "position" : "depth");
  if (planes.empty()) fail(ErrorKind::usage, "there is no plane depth, and no position");
  if (has_position() && !given("depth").empty())
    fail(ErrorKind::usage, "there are depth and position: both give the distance of surfaces");
  return planes.front();
}

/// Planes stand where the program has files, so that the table's conditions hold for them.
Settings Session::settings() const {
  depth();
  Settings settings;
  InputSettings& input = settings.input;
  settings.output.output = "memory";
  for (const auto& facts : kPlanes)
    if (facts.file && !given(facts.name).empty()) input.*facts.file = "plane";
  for (std::size_t i = 0; i < given("behind").size(); i++) input.behind[i] = "plane";
  std::vector<OptionValue> all;
  for (const auto& [name, text] : presets_) std::ranges::copy(preset_values(name, text), std::back_inserter(all));
  std::ranges::copy(values_, std::back_inserter(all));
  settings = with_values(settings, all);
  check_settings(settings);
  return settings;
}

Camera Session::camera_by(const Settings& settings, const Window& window, int frame) const {
  const std::string name = "camera";
  const bool is_given = camera_json_ || !pinhole_.empty();
  if (is_given && names_a_camera(settings.input))
    fail(ErrorKind::usage,
         "there is a camera, and --fov, --vertical-fov, --focal-px, --focal or --ortho-width gives another: give only "
         "one of them");
  if (camera_json_) return camera_of(*camera_json_, name, window, frame);
  if (pinhole_.empty() && !names_a_camera(settings.input))
    fail(ErrorKind::usage,
         "there is no camera: give one, or set --fov or --vertical-fov (degrees), --focal-px, --focal with --aperture "
         "(mm), or "
         "--ortho-width (scene units)");
  if (pinhole_.empty()) return camera_for(settings.input, window, 1, frame);
  const auto& p = pinhole_;
  std::string text = fmt::format(R"({{"resolution": [{}, {}], "fx": {}, "fy": {}, "cx": {}, "cy": {})", window.width,
                                 window.height, p[0], p[1], p[2], p[3]);
  if (p.size() > 4) {
    const auto row = [&](int i) { return fmt::format("[{}]", fmt::join(p.begin() + i, p.begin() + i + 4, ", ")); };
    text += fmt::format(R"(, "world_to_camera": [{}, {}, {}, {}])", row(4), row(8), row(12), row(16));
  }
  return camera_of(text + "}", name, window, frame);
}

void Session::read_normals(Reading& reading, const Settings& settings) const {
  const Planes& normal = given("normal");
  if (normal.empty()) return;
  reading.normal_space = decided(settings.input.normal_space, reading.camera.normal_space,
                                 reading.camera.view_from_world ? NormalSpace::automatic : NormalSpace::view);
  if (reading.normal_space == NormalSpace::automatic)
    fail(ErrorKind::usage, "normal: set --normal-space to world or view, since planes do not tell");
  if (reading.normal_space == NormalSpace::world && !reading.camera.view_from_world)
    fail(ErrorKind::usage, "normal: --normal-space world needs a camera with world_to_camera");
  reading.flip_normal = settings.input.flip_normal;
  reading.normal_encoding =
      decided(settings.input.normal_encoding, reading.camera.normal_encoding, NormalEncoding::signed_float);
  const bool is_packed =
      reading.normal_encoding == NormalEncoding::octahedral || reading.normal_encoding == NormalEncoding::spheremap;
  reading.normal_unorm =
      reading.normal_encoding == NormalEncoding::unorm || (is_packed && is_unorm(normal.front().values));
}

Reading Session::reading_by(const Settings& settings, int frame) const {
  const Given& first = depth();
  const InputSettings& input = settings.input;
  Reading reading;
  reading.data = reading.display = {0, 0, first.width, first.height};
  reading.camera = camera_by(settings, reading.data, frame);
  reading.depth_kind =
      has_position() ? DepthKind::position : decided(input.depth_kind, reading.camera.depth_kind, DepthKind::planar);
  if (!has_position() && reading.depth_kind == DepthKind::position)
    fail(ErrorKind::usage, "depth: --depth-kind position takes the plane position, of three channels");
  reading.depth_range = input.depth_range;
  if (!reading.depth_range.near) reading.depth_range.near = reading.camera.near;
  if (!reading.depth_range.far) reading.depth_range.far = reading.camera.far;
  reading.depth_range.reversed |= reading.camera.reversed_z;
  reading.position_space = decided(input.position_space, PositionSpace::automatic,
                                   reading.camera.view_from_world ? PositionSpace::automatic : PositionSpace::view);
  if (has_position() && reading.position_space == PositionSpace::automatic)
    fail(ErrorKind::usage, "position: set --set position-space to world or view, since planes do not tell");
  reading.depth_scale = input.depth_scale;
  reading.sky = input.sky;
  reading.cuts_ramps = input.ramps == "cut";
  reading.depth_is_half = first.is_half;
  read_normals(reading, settings);
  const auto& kinds = input.behind_kinds;
  for (const auto& plane : given("behind")) {
    const std::size_t number = reading.behind.size();
    const BehindKind kind = kinds.empty() ? BehindKind::surfaces : kinds[kinds.size() > 1 ? number : 0];
    reading.behind.push_back({.kind = kind, .is_half = plane.is_half});
  }
  reading.matte.outside = input.matte_outside;
  reading.occluders.ignores = !given("ignore").empty();
  return reading;
}

void Session::close_device() {
  device_choice_.clear();
  device_name_.clear();
  gpu_.reset();
  device_.reset();
}

void Session::open_device(const DeviceSettings& settings) {
  const std::string choice = fmt::format("{} {} {}", settings.device, settings.require_gpu, settings.validate);
  if (device_ && choice == device_choice_) return;
  close_device();
  device_ = std::make_unique<gpu::Device>(gpu::DeviceOptions{
      .choice = settings.device, .require_gpu = settings.require_gpu, .validate = settings.validate});
  gpu_ = std::make_unique<gpu::Recorder>(*device_);
  device_choice_ = choice;
  device_name_ = device_->info().name;
}

void Session::run(int frame) {
  results_.clear();
  notes_.clear();
  Settings all = settings();
  Reading reading = reading_by(all, frame);
  if (all.output.aov_space == NormalSpace::world && !reading.camera.view_from_world)
    fail(ErrorKind::usage, "--set aov-space=world needs a camera with world_to_camera");
  if (all.output.multi_bounce && given("albedo").empty() && !all.input.albedo_value)
    fail(ErrorKind::usage, "--set multi-bounce needs the plane albedo, or a number for --set albedo");
  std::vector<float> behind;
  HostPlanes planes = planes_over(reading.data, behind);
  Notes notes = check_planes(reading, planes, all.input);
  const std::vector<float> cut = with_ramps_cut(reading, planes[RawPlane::depth]);
  if (reading.cuts_ramps) planes[RawPlane::depth] = cut;
  if (depends_on_depth(all.estimator)) {
    const auto radii = radii_by_depth(all.estimator, reading.camera, median_depth(reading, depth().values));
    take_radii(all.estimator, radii.empty() ? std::vector{1.0} : radii);  // without a surface there is no AO to compute
  }
  add_new(notes, check_radius(reading, planes[RawPlane::depth], all.estimator));
  std::string sentences;
  for (const auto& note : notes) sentences += (sentences.empty() ? "" : "\n") + in_library_words(note.text);
  open_device(all.device);
  try {
    compute(all, reading, planes, frame);
  } catch (const gpu::DeviceLost&) {
    close_device();
    throw;
  } catch (...) {
    gpu_->abandon();
    throw;
  }
  notes_ = std::move(sentences);
}

HostPlanes Session::planes_over(const Window& data, std::vector<float>& behind) const {
  HostPlanes planes;
  for (const auto& facts : kPlanes)
    for (const auto& plane : given(facts.name)) {
      if (plane.width != data.width || plane.height != data.height)
        fail(ErrorKind::input, "{} has {} x {} pixels, and the depth {} x {}",
             std::string(kRawPlanes[std::size_t(facts.plane)].name).substr(4), plane.width, plane.height, data.width,
             data.height);
      planes[facts.plane] = plane.values;
      if (facts.plane == RawPlane::behind) behind.insert(behind.end(), plane.values.begin(), plane.values.end());
    }
  planes[RawPlane::behind] = behind;
  return planes;
}

void Session::compute(const Settings& settings, const Reading& reading, const HostPlanes& planes, int frame) {
  FrameInputs inputs = upload(*gpu_, reading, planes, frame);
  inputs.albedo_value = settings.input.albedo_value.value_or(0);
  if (in_world(reading.camera, settings.output)) inputs.aov_from_view = transposed(*reading.camera.view_from_world);
  const FrameOutputs outputs = run_chain(*gpu_, inputs, settings.estimator, settings.output);
  const int messages = device_->validation_messages();
  gpu_->run();
  if (settings.device.validate && device_->validation_messages() > messages)
    fail(ErrorKind::device, "the validation layer has {}",
         counted(std::size_t(device_->validation_messages() - messages), "message"));
  radius_ = settings.estimator.radius;
  note_results(outputs, settings, reading.data.width, reading.data.height);
}

void Session::note_results(const FrameOutputs& outputs, const Settings& settings, int width, int height) {
  width_ = width;
  height_ = height;
  counts_ = outputs.counts->as<FrameCounts>()[0];
  compute_ms_ = 0;
  for (const auto& pass : gpu_->passes()) compute_ms_ += pass.ms;
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  for (const auto& aov : aovs_of(settings.output)) {
    const gpu::Buffer* planes = outputs.*aov.planes;
    // The one plane of AO stands for all its channels.
    const std::size_t there = planes->as<const float>().size() / pixels;
    results_.push_back({lower_case(aov.name), std::max(there, channels_of(aov, there).size()), planes});
  }
}

std::size_t Session::components(const std::string& aov) const {
  const auto result = std::ranges::find(results_, lower_case(aov), &Result::name);
  return result == results_.end() ? 0 : result->components;
}

void Session::get(const std::string& aov, void* data, const alcove_layout* layout) const {
  const auto result = std::ranges::find(results_, lower_case(aov), &Result::name);
  if (result == results_.end())
    fail(ErrorKind::usage, "{}: {}", aov,
         results_.empty() ? "nothing was computed; alcove_run() does" : "the option aov did not name it");
  if (!data || !layout) fail(ErrorKind::usage, "{}: there is no place for it", aov);
  check_layout(aov, *layout);
  if (layout->width != width_ || layout->height != height_ || std::size_t(layout->components) != result->components)
    fail(ErrorKind::usage, "{}: it has {} x {} pixels of {} components, and the place for it {} x {} of {}", aov,
         width_, height_, result->components, layout->width, layout->height, layout->components);
  const auto there = result->planes->as<const float>();
  std::vector<float> repeated;
  const std::size_t wanted = result->components * std::size_t(width_) * std::size_t(height_);
  while (there.size() < wanted && repeated.size() < wanted) repeated.insert(repeated.end(), there.begin(), there.end());
  planes_to(repeated.empty() ? there : repeated, data, *layout);
}

double Session::number(const std::string& name) const {
  if (results_.empty()) return NAN;
  if (name == "compute-ms") return compute_ms_;
  if (name == "sky-pixels") return counts_.sky;
  if (name == "repaired-depth") return counts_.repaired_depth;
  if (name == "repaired-normals") return counts_.repaired_normals;
  if (name == "turned-normals") return counts_.turned_normals;
  return name == "radius" ? radius_.value_or(NAN) : NAN;
}

}  // namespace alcove
