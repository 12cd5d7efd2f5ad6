// Collects what the files hold, what is understood of it, and what is missing.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/inspect.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <regex>

#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/frame/find/behind.h"
#include "core/frame/settle/settle.h"

namespace alcove {
namespace {

// Deep samples, counted band by band.

/// How the depth of a file's samples is read.
std::string depth_of(const FrameSource& source, const ExrFile& file) {
  const auto is_it = [&](const DeepFiles::Element& element) {
    return source.files[element.file].path() == file.path();
  };
  const bool is_taken = source.channels.deep && std::ranges::any_of(source.channels.deep->elements, is_it);
  if (!is_taken || !source.evidence) return "";
  const ChannelRef& own = source.channels[RawPlane::depth][0];
  if (source.part_of(own).deep) return "the depth of the frame";
  const DepthKind kind =
      source.reading.deep_kind == DepthKind::automatic ? source.reading.depth_kind : source.reading.deep_kind;
  return kind == DepthKind::ray ? "along the ray" : kind == DepthKind::planar ? "planar" : word_of(kind);
}

/// Reads all samples of a file of a frame that is settled, or that could not be; nothing where it has no deep parts.
/// Fails as reading them does.
std::optional<InspectedDeep> deep_samples(const FrameSource& source, const ExrFile& file,
                                          const InputSettings& settings) {
  const std::vector<int> parts = deep_parts_of(file, settings.layer, source.channels.view);
  if (parts.empty()) return std::nullopt;
  ExrFile samples(file.path(), "INPUT");
  const ExrPart& first = samples.parts()[std::size_t(parts.front())];
  samples.take_deep(parts, deep_rules(source, file, parts, settings));
  const std::size_t band = std::size_t(first.data.width) * std::size_t(first.rows_together);
  std::vector<float> surfaces(2 * kMostDeepSurfaces * band, kNoDeepSurface);
  std::vector<ExrRead> reads;
  for (const bool back : {false, true})
    for (std::size_t i = 0; i < kMostDeepSurfaces; i++)
      reads.push_back({parts.front(), deep_channel(i, back), surfaces.data() + reads.size() * band});
  const auto is_surface = [](float z) { return z < kNoDeepSurface; };
  std::vector<bool> has_any(reads.size());
  for (int y = 0; y < first.data.height; y += first.rows_together) {
    samples.read(reads, y, std::min(first.rows_together, first.data.height - y));
    for (std::size_t i = 0; i < reads.size(); i++)
      has_any[i] = has_any[i] || std::ranges::any_of(std::span(reads[i].to, band), is_surface);
  }
  InspectedDeep deep{file.path(), parts, *first.deep, samples.deep_counts(), depth_of(source, file), {}};
  for (std::size_t i = 0; i < reads.size(); i++)
    if (has_any[i]) deep.channels.push_back(reads[i].channel);
  return deep;
}

// Names that have been seen of back faces and of peels.

/// What a channel of this full name, in lower case, may hold.
std::optional<BehindKind> kind_by(const std::string& name) {
  static const std::regex backs(R"((.*\.)?(zback|z\.back|depth_back|backz))");
  static const std::regex peels(R"((.*\.)?(peel[^.]*|depth[2-9]|layer[2-9])(\.z)?)");
  if (std::regex_match(name, backs)) return BehindKind::backs;
  return std::regex_match(name, peels) ? std::optional(BehindKind::surfaces) : std::nullopt;
}

/// Whether the frame reads the channel already.
bool is_read(const FrameSource& source, const ChannelRef& ref) {
  const auto has = [&](const std::vector<ChannelRef>& plane) { return std::ranges::find(plane, ref) != plane.end(); };
  return std::ranges::any_of(source.channels.entries, has);
}

}  // namespace

std::vector<HiddenGuess> hidden_guesses(const FrameSource& source, const InputSettings& settings) {
  std::vector<HiddenGuess> guesses;
  for (std::size_t file = 0; file < source.files.size(); file++) {
    const ExrFile& of = source.files[file];
    const std::string view = view_in(of, source.channels.view);
    const bool is_of_view = view.empty() || source.channels.view.empty() || same_name(view, source.channels.view);
    if (!is_of_view || of.display() != source.reading.display) continue;
    for (const auto& channel : channels_in(of, file, settings.layer, view)) {
      std::optional<BehindKind> kind;
      for (const auto& name : channel.spellings)
        if (!kind) kind = kind_by(name);
      const bool fits = kind && !channel.subsampled && source.part_of(channel.ref).data == source.reading.data &&
                        channel.full.find(',') == channel.full.npos;
      if (fits && !is_read(source, channel.ref)) guesses.push_back({of.path(), channel.full, *kind});
    }
  }
  const std::size_t room =
      kMostBehind - std::size_t(std::ranges::count_if(settings.behind, [](const auto& path) { return !path.empty(); }));
  if (guesses.size() > room) guesses.resize(room);
  return guesses;
}

// A frame.

namespace {

/// The options by which a run would take all of them; "" where there are none.
std::string options_for(const std::vector<HiddenGuess>& guesses) {
  std::string files, channels, kinds;
  for (const auto& guess : guesses) {
    files += fmt::format(" --behind {}", for_shell(guess.file));
    channels += (channels.empty() ? "" : ",") + guess.channel;
    kinds += (kinds.empty() ? "" : ",") + word_of(guess.kind);
  }
  if (guesses.empty()) return "";
  return fmt::format("{} --set behind-channel={} --behind-kind {}", files.substr(1), for_shell(channels), kinds);
}

std::vector<InspectedFile> files_of(const FrameSource& source) {
  std::vector<InspectedFile> files;
  for (const auto& file : source.files) {
    files.push_back(
        {file.path(), file.display(), file.pixel_aspect(), {}, cryptomattes_of(file, source.channels.view)});
    for (std::size_t part = 0; part < file.parts().size(); part++)
      files.back().parts.push_back({file.parts()[part], file.attribute_texts(int(part))});
  }
  return files;
}

void add_aov(Inspection& found, const std::string& name, const FrameSource& source,
             const std::vector<ChannelRef>& channels, bool is_chosen) {
  if (channels.empty()) return;
  InspectedAov aov{name, source.files[channels[0].file].path(), channels[0].part, {}, is_chosen};
  for (const auto& channel : channels) aov.channels.push_back(channel.channel);
  found.aovs.push_back(std::move(aov));
}

/// Names the options that gave the camera.
std::string options_of_camera(const InputSettings& settings) {
  if (!settings.camera.empty()) return "--camera";
  if (settings.fov) return "--fov";
  if (settings.vertical_fov) return "--vertical-fov";
  if (settings.focal_px) return "--focal-px";
  return settings.focal ? "--focal and --aperture" : "--ortho-width";
}

InspectedCamera camera_of(const FrameSource& source, const InputSettings& settings) {
  const Camera& camera = source.reading.camera;
  if (!source.camera_from.empty()) return {camera, source.camera_from};
  const std::string placed = camera.placement_from.empty() ? "" : " and the header's " + camera.placement_from;
  return {camera, options_of_camera(settings) + placed};
}

InspectedNormals normals_of(const RawFrame& raw, const FrameSource& source) {
  const NormalStatistics s = normal_statistics(raw.normal, raw.depth, depth_map_of(source.reading));
  InspectedNormals normals{.space = source.reading.normal_space,
                           .encoding = encoding_name(source.reading.normal_encoding, source.reading.normal_unorm),
                           .flips = source.reading.flip_normal,
                           .least = s.least,
                           .most = s.most,
                           .mean_length = {},
                           .unit_share = {},
                           .scores = {},
                           .chosen = {}};
  if (has_lengths(source)) {
    normals.mean_length = source.reading.normal_unorm ? s.unorm_mean_length : s.mean_length;
    normals.unit_share = source.reading.normal_unorm ? s.unorm_unit_share : s.unit_share;
  }
  normals.scores = score_normals({source.reading, raw.normal, raw.depth});
  if (const auto* chosen = score_of(normals.scores, source.reading.normal_space, source.reading.flip_normal))
    normals.chosen = *chosen;
  return normals;
}

/// A frame being looked at.
struct Inspector {
  const InputSettings& settings;  // as the user gave them
  const CommandNames& run;        // of the command
  InputSettings reading;          // with a camera in any case
  bool has_camera;
  int frame;
  std::optional<FrameSource> known;  // the same frame, where it was found already
  FrameSource source = {};
  RawFrame raw = {};
  Evidence seen = {};  // also where the frame is refused
  Inspection found = {};

  /// Adds those that can be opened: why others cannot is told.
  void add_files(std::span<const std::string> paths) {
    for (const auto& path : paths) try {
        const auto is_it = [&](const ExrFile& file) { return file.path() == path; };
        if (!path.empty() && std::ranges::none_of(source.files, is_it))
          source.files.push_back(open_image(path, "INPUT", Formats::of_frames));
      } catch (const Error&) {
        continue;
      }
  }

  /// Finds the frame, if need be without what lies behind its first surface: that says more than that it is refused.
  void find_source() {
    try {
      source = known ? *std::move(known) : find_frame(reading, false, frame);
    } catch (const Error& error) {
      InputSettings without = reading;
      without.behind = {};
      without.behind_channels.clear();
      without.behind_kinds.clear();
      without.deep = {};
      if (!has_hidden_sources(reading) || main_input(without).empty()) throw;
      source = find_frame(without, false, frame);
      found.refused.push_back(error.what());
      reading = without;
      add_files(settings.behind);
      add_files(settings.deep);
    }
  }

  /// Finds the channels. Returns false where some are missing, which is then part of what was found.
  bool find() {
    try {
      find_source();
    } catch (const Error& error) {
      for (const auto& [option, path] : {std::pair("INPUT", settings.input),
                                         {"--depth", settings.depth},
                                         {"--normal", wants_normals(settings) ? settings.normal : ""},
                                         {"--position", settings.position}})
        if (!path.empty())
          source.files.push_back(open_image(path, option, Formats::of_frames));  // what cannot be read fails here
      found.missing.push_back(error.what());
      return false;
    }
    source.open.camera = !has_camera;
    found.source = InspectedSource{source.program.rules->name, source.program.by};
    add_aov(found, source.channels[RawPlane::depth].size() == 3 ? "position" : "depth", source,
            source.channels[RawPlane::depth], !settings.depth_channel.empty() || !settings.position_channels.empty());
    add_aov(found, "normal", source, source.channels[RawPlane::normal], !settings.normal_channels.empty());
    for (std::size_t i = 0; i < source.channels[RawPlane::behind].size(); i++)
      add_aov(found, fmt::format("behind{}", i + 1), source, {source.channels[RawPlane::behind][i]},
              !settings.behind_channels.empty());
    found.hidden = hidden_guesses(source, reading);
    found.hidden_options = options_for(found.hidden);
    if (source.channels[RawPlane::normal].empty() && wants_normals(settings))
      found.missing.push_back(
          "normals: they would be reconstructed from depth; --normal or --normal-channels names them");
    if (has_camera) found.camera = camera_of(source, settings);
    return true;
  }

  /// Reads depth and normals. Returns false where the pixels cannot be read.
  bool read() {
    require_host_room(source.depth_path(), source.reading.data);
    try {
      raw = read_raw_frame(source, source.reading.data);
    } catch (const Error& error) {
      found.suspicious.push_back({NoteCode::damaged_file, error.what()});
      found.unreadable = error;
      return false;
    }
    found.depth = InspectedDepth{word_of(source.reading.depth_kind), statistics_of(raw.depth), {}, {}};
    return true;
  }

  /// Settles what the pixels decide. A camera that nobody gave has nothing to say.
  void settle_frame() {
    const auto notes = source.notes;
    settle(source, reading, raw, seen);
    source.evidence = seen;
    found.depth->kind = word_of(source.reading.depth_kind);
    if (has_camera) return;
    source.notes = notes;
    if (settings.normal_space == NormalSpace::automatic) source.reading.normal_space = source.program.normal_space;
  }

  void look_at_normals() {
    if (raw.normal.empty()) return;
    found.normals = normals_of(raw, source);
    if (has_camera) return;
    found.normals->scores.clear();
    found.normals->chosen.reset();
  }

  /// Whether it is known what the depth means, be it that the frame is refused for its normals.
  bool knows_depth() const {
    return !source.open.depth_kind ||
           std::ranges::any_of(seen.guesses, [](const Guess& guess) { return guess.what == "depth kind"; });
  }

  void describe() {
    found.depth->distances = distances_of(source, raw.depth);
    found.depth->scores = seen.depth_scores;
    look_at_normals();
  }

  /// Looks at the pixels as they are understood.
  void look() {
    try {
      settle_frame();
      describe();
      if (found.refused.empty()) found.command = command_of(source, run, has_camera);
    } catch (const Error& error) {
      found.missing.push_back(error.what());
      describe_refused();
    }
    found.shows_surfaces = seen.tells;
    found.suspicious = source.suspicious;
    found.guesses = seen.guesses;
    found.notes = source.notes;
  }

  /// Describes what the refusal of a frame leaves, since that shows why.
  void describe_refused() {
    if (!knows_depth()) {
      found.depth->kind = "undecided";
      return;
    }
    try {
      describe();
    } catch (const Error&) {
      // It is what the frame was refused for, such as planes that nobody gave.
    }
  }

  /// Samples may make more surfaces than any pixel of theirs does.
  void leave_out_empty(const InspectedDeep& deep) {
    const auto is_empty = [&](const InspectedAov& aov) {
      return aov.name.starts_with("behind") && aov.file == deep.file && std::ranges::count(deep.parts, aov.part) > 0 &&
             std::ranges::count(deep.channels, aov.channels.front()) == 0;
    };
    std::erase_if(found.aovs, is_empty);
  }

  /// Counts the samples of deep files.
  void look_at_deep() {
    for (const auto& file : source.files) try {
        if (auto deep = deep_samples(source, file, settings)) found.deep.push_back(std::move(*deep));
        // Those of several files together show more than each does.
        if (!found.deep.empty() && found.deep.back().file == file.path() &&
            (!source.channels.deep || source.channels.deep->elements.size() == 1))
          leave_out_empty(found.deep.back());
      } catch (const Error& error) {
        found.suspicious.push_back({NoteCode::damaged_file, error.what()});
      }
  }

  /// Adds up the light passes, where it is known which pixels show surfaces.
  void look_at_light(FrameSource& beauty) {
    if (!found.depth->distances) return;
    found.light = light_passes_of(
        beauty, planar_depths(raw.depth, depth_map_of(source.reading), view_of(source.reading, source.reading.data)));
    if (found.light && !found.light->adds_up)
      found.suspicious.push_back({NoteCode::light_passes, missing_light_text(*found.light)});
  }

  /// Says what is ambient in a composite of a beauty of which no part tells it, since a run warns of that.
  void answer_ambient(const FrameSource& beauty) {
    const bool is_whole = beauty.channels[RawPlane::indirect].empty() && settings.ambient.empty();
    if (is_whole && found.command.find(" --composite ") != found.command.npos) found.command += " --set ambient=beauty";
  }

  /// Neither camera nor normals matter for it, so that no camera is solved again.
  void find_beauty() {
    InputSettings alone = names_a_camera(reading) ? reading : with_some_camera(reading);
    alone.normal = "none";
    try {
      FrameSource beauty = find_frame(alone, true, frame);
      add_aov(found, "beauty", beauty, beauty.channels[RawPlane::beauty], !settings.beauty_channels.empty());
      add_aov(found, "indirect", beauty, beauty.channels[RawPlane::indirect], false);
      add_aov(found, "diffuse_color", beauty, beauty.channels[RawPlane::diffuse_color], false);
      answer_ambient(beauty);
      look_at_light(beauty);
    } catch (const Error&) {
      found.missing.push_back("beauty: only --composite needs one; --beauty or --set beauty-channels names it");
    }
  }
};

}  // namespace

Distances distances_of(const FrameSource& source, std::span<const float> raw) {
  std::vector<float> planar =
      planar_depths(raw, depth_map_of(source.reading), view_of(source.reading, source.reading.data));
  const std::size_t pixels = planar.size();
  std::erase_if(planar, [](float z) { return std::isinf(z); });
  Distances distances{1 - double(planar.size()) / double(pixels), {}, {}, {}};
  if (planar.empty()) return distances;
  distances.median = value_at_rank(planar, planar.size() / 2);
  distances.nearest = *std::ranges::min_element(planar);
  distances.farthest = *std::ranges::max_element(planar);
  return distances;
}

CameraSearch look_for_camera(const InputSettings& settings, int frame) {
  if (names_a_camera(settings)) return {};
  try {
    return {true, "", find_frame(settings, false, frame)};
  } catch (const NoCamera& error) {
    return {false, error.why, {}};
  } catch (const Error&) {
    // Something else is missing too, which comes later.
  }
  try {
    if (may_tell_camera(settings)) return {};
  } catch (const Error&) {
    // So is this.
  }
  return {false, "", {}};
}

Inspection inspect_frame(const InputSettings& settings, int frame, const CommandNames& run) {
  CameraSearch search = look_for_camera(settings, frame);
  const bool has_camera = search.is_found;
  Inspector inspector{settings,   run,   has_camera ? settings : with_some_camera(settings),
                      has_camera, frame, std::move(search.frame)};
  const bool is_found = inspector.find();
  // A channel that is missing comes first: without it no camera helps.
  auto& missing = inspector.found.missing;
  const bool turns_normals = is_found && expects_world_normals(inspector.source, settings);
  if (!has_camera)
    missing.insert(is_found ? missing.begin() : missing.end(),
                   "camera: " + search.why + (search.why.empty() ? "" : "; ") +
                       (turns_normals ? kWorldCameraOptions : kCameraOptions));
  const bool is_read = is_found && inspector.read();
  if (is_read) inspector.look();
  if (is_found) inspector.look_at_deep();
  if (is_read) inspector.find_beauty();
  inspector.found.files = files_of(inspector.source);
  return inspector.found;
}

}  // namespace alcove
