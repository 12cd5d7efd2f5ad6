// The option table and what reads it.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"

#include <cmath>
#include <map>
#include <sstream>

#include "cli/option_words.h"
#include "cli/parsing.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/flat_toml.h"
#include "core/base/text.h"
#include "core/chain/aov.h"
#include "core/chain/debug_view.h"
#include "core/frame/input_rules.h"

namespace alcove {
namespace {

/// Builds rows of one group after the other.
class Table {
 public:
  std::vector<OptionRow> rows;

  void group(const char* name) { group_ = name; }

  void text(const std::string& name, std::string& value, const char* what, const std::string& sentence) {
    row(name, what, "", "", sentence, value, [name, &value](CLI::App& app) { return app.add_option(name, value); });
  }

  void word(const std::string& name, std::string& value, const std::vector<std::string>& words,
            const std::string& sentence) {
    row(name, fmt::format("{}", fmt::join(words, "|")), "", "", sentence, value,
        [name, &value, words](CLI::App& app) { return app.add_option(name, value)->check(check_of(words)); });
  }

  template <class T>
  void choice(const std::string& name, T& value, const std::string& sentence) {
    const auto& names = names_of<T>();
    std::vector<std::string> words;
    std::string present;
    for (const auto& [word, kind] : names) {
      words.push_back(word);
      if (kind == value) present = word;
    }
    // A function option instead of a transformed enum, so that --print-config writes the word and not its number.
    row(name, fmt::format("{}", fmt::join(words, "|")), "", "", sentence, present,
        [name, &value, &names, words](CLI::App& app) {
          return app
              .add_option_function<std::string>(name,
                                                [&value, &names](const std::string& word) { value = names.at(word); })
              ->check(check_of(words));
        });
  }

  template <class T>
  void number(const std::string& name, T& value, const char* unit, const Range& range, const std::string& sentence) {
    row(name, "NUMBER", unit, range.text, sentence, fmt::format("{}", value),
        [name, &value, range](CLI::App& app) { return app.add_option(name, value)->check(check_of(range)); });
  }

  void number(const std::string& name, std::optional<double>& value, const char* unit, const Range& range,
              const std::string& sentence) {
    row(name, "NUMBER", unit, range.text, sentence, "",
        [name, &value, range](CLI::App& app) { return app.add_option(name, value)->check(check_of(range)); });
  }

  void flag(const std::string& name, bool& value, const std::string& sentence) {
    row(name, "", "", "", sentence, "", [name, &value](CLI::App& app) {
      return app.add_flag(name, value)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    });
  }

  void row(const std::string& name, const std::string& value, const char* unit, const std::string& range,
           const std::string& sentence, const std::string& default_text, std::function<CLI::Option*(CLI::App&)> add) {
    rows.push_back({group_, name, value, unit, range, sentence, default_text, std::move(add)});
  }

 private:
  std::string group_;
};

void read_thickness(const std::string& text, EstimatorSettings& settings) {
  settings.thickness = text == "auto"       ? ThicknessKind::automatic
                       : text == "infinite" ? ThicknessKind::infinite
                                            : ThicknessKind::constant;
  if (settings.thickness != ThicknessKind::constant) return;
  double length = 0;
  if (!CLI::detail::lexical_cast(text, length) || !(length > 0) || std::isinf(length))
    throw CLI::ValidationError("--thickness",
                               fmt::format("{} is neither auto nor infinite nor a length above 0", text));
  settings.thickness_length = length;
}

void read_radii(const std::vector<double>& radii, EstimatorSettings& settings) {
  settings.radius = radii.front();
  settings.further_radii.assign(radii.begin() + 1, radii.end());
}

/// --albedo: a number is the albedo of all surfaces, all else a file.
void read_albedo(const std::string& text, InputSettings& settings) {
  double value = 0;
  const bool is_number = CLI::detail::lexical_cast(text, value);
  if (is_number && !(value >= 0 && value <= 1))
    throw CLI::ValidationError("--albedo", fmt::format("{} is neither a file nor a number from 0 to 1", text));
  settings.albedo = is_number ? "" : text;
  settings.albedo_value = is_number ? std::optional(value) : std::nullopt;
}

/// --far: a distance, or inf.
void read_far(const std::string& text, std::optional<double>& far) {
  double value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !(value > 0))
    throw CLI::ValidationError("--far", fmt::format("{} is neither a distance above 0 nor inf", text));
  far = value;
}

/// --chunk I/N.
void read_chunk(const std::string& text, FrameSettings& frames) {
  const auto words = CLI::detail::split(text, '/');
  const bool fine = words.size() == 2 && CLI::detail::lexical_cast(words[0], frames.chunk) &&
                    CLI::detail::lexical_cast(words[1], frames.chunks);
  if (!fine || frames.chunk < 1 || frames.chunk > frames.chunks)
    throw CLI::ValidationError("--chunk", fmt::format("{} is not I/N, with I from 1 to N", text));
}

void read_roi(const std::string& text, std::optional<Region>& roi) {
  const auto words = CLI::detail::split(text, ',');
  Region region;
  int* const numbers[] = {&region.x, &region.y, &region.width, &region.height};
  bool fine = words.size() == 4;
  for (std::size_t i = 0; fine && i < 4; i++) fine = CLI::detail::lexical_cast(words[i], *numbers[i]);
  if (!fine || region.width <= 0 || region.height <= 0)
    throw CLI::ValidationError("--roi", fmt::format("{} is not X,Y,WIDTH,HEIGHT in whole pixels", text));
  roi = region;
}

/// --flip-normal: axes, each once at most.
void read_flips(const std::string& text, NormalFlips& flips) {
  flips = {};
  for (const char axis : text) {
    bool* flip = axis == 'x' ? &flips.x : axis == 'y' ? &flips.y : axis == 'z' ? &flips.z : nullptr;
    if (!flip || *flip)
      throw CLI::ValidationError("--flip-normal", fmt::format("{} is none of x, y, z, xy, xz, yz, xyz", text));
    *flip = true;
  }
}

void read_kernel(const std::string& text, EstimatorSettings& settings) {
  settings.denoise_kernel.clear();
  for (const auto& word : CLI::detail::split(text, ',')) {
    double weight = 0;
    if (!CLI::detail::lexical_cast(word, weight) || !(weight >= 0) || std::isinf(weight))
      throw CLI::ValidationError("--denoise-kernel", fmt::format("{} is no weight of 0 or more", word));
    settings.denoise_kernel.push_back(weight);
  }
  const std::size_t count = settings.denoise_kernel.size();
  if (count < 2 || count > 9)
    throw CLI::ValidationError("--denoise-kernel", fmt::format("{} has {} weights, not 2 to 9", text, count));
  if (settings.denoise_kernel.front() == 0)
    throw CLI::ValidationError("--denoise-kernel", fmt::format("{} has no weight at the centre", text));
}

void add_input_rows(Table& table, InputSettings& s) {
  table.group("Input");
  table.text("--depth", s.depth, "FILE", "an EXR, DDS or TIFF of the depth alone; else it is in INPUT");
  table.text("--normal", s.normal, "FILE", "an EXR, DDS, TIFF or PNG of the normals alone");
  table.text("--position", s.position, "FILE", "an EXR of the positions, instead of a depth");
  table.text("--beauty", s.beauty, "FILE", "an EXR of the beauty, and of the indirect diffuse light, for --composite");
  table.text("--material-ao", s.material_ao, "FILE", "an EXR of the materials' own AO, multiplied in");
  table.row("--albedo", "FILE|NUMBER", "", "0 to 1",
            "an EXR of the diffuse colour for --multi-bounce, or one number; else it is in the beauty's file", "",
            [&s](CLI::App& app) {
              return app.add_option_function<std::string>("--albedo",
                                                          [&s](const std::string& text) { read_albedo(text, s); });
            });
  table.text("--depth-channel", s.depth_channel, "NAME", "the depth channel; else found by its usual names");
  table.text("--normal-channels", s.normal_channels, "LAYER|X,Y[,Z]",
             "the normal's layer, or its channels; of two, z is rebuilt");
  table.text("--position-channels", s.position_channels, "LAYER|X,Y,Z",
             "the position's layer, or its three channels, instead of a depth");
  table.text("--beauty-channels", s.beauty_channels, "LAYER|R,G,B[,A]", "the beauty's layer, or its channels");
  table.text("--material-ao-channel", s.material_ao_channel, "NAME",
             "the material AO's channel, of --material-ao or else of INPUT");
  table.text("--albedo-channels", s.albedo_channels, "LAYER|R,G,B", "the diffuse colour's layer, or its channels");
  table.text("--layer", s.layer, "NAME", "look only at this layer or part");
  table.text("--view", s.view, "NAME", "of a stereo file; else its default view");
  table.row("--roi", "X,Y,WIDTH,HEIGHT", "px of the display window", "",
            "compute and write only this region; its surroundings are read as far as occluders reach", "",
            [&s](CLI::App& app) {
              return app.add_option_function<std::string>("--roi",
                                                          [&s](const std::string& text) { read_roi(text, s.roi); });
            });
  table.word("--source", s.source, source_names(),
             "the program that wrote the frame, of presets/input; auto: by its header and channels");
  table.choice("--depth-kind", s.depth_kind,
               "planar: along the optical axis; ray: to the eye; inverse: 1/planar; others: see Inputs in the README; "
               "auto: what the camera file says, else what fits the frame");
  table.number("--near", s.depth_range.near, "file units", above(0),
               "near plane of device or normalized depth; else the camera file's");
  table.row("--far", "NUMBER|inf", "file units", "above 0",
            "far plane of device, normalized or log depth; else the camera file's", "", [&s](CLI::App& app) {
              return app.add_option_function<std::string>(
                  "--far", [&s](const std::string& text) { read_far(text, s.depth_range.far); });
            });
  table.flag("--reversed-z", s.depth_range.reversed, "device, normalized or log depth is largest at the near plane");
  table.choice("--device-range", s.depth_range.device,
               "of device depth between the planes; -1..1: OpenGL's normalized device coordinates");
  table.number("--log-constant", s.depth_range.log_constant, "1 / file units", above(0),
               "C of log depth, z = ((1 + C far)^d - 1) / C");
  table.number("--depth-scale", s.depth_scale, "", above(0), "scene units a unit of the depth channel");
  table.number("--sky", s.sky, "file units", above(0), "depth at or beyond it is sky, as are 0, infinity and NaN");
  table.choice("--normal-space", s.normal_space,
               "the space of the normals; auto: what the camera file says, else what fits the frame");
  table.choice("--normal-encoding", s.normal_encoding,
               "unorm: 0.5 + 0.5 n; octahedral, spheremap: two channels; auto: signed or unorm by their values");
  table.row("--flip-normal", "xyz", "", "", "axes of the normals that point the other way, in the normals' own space",
            "", [&s](CLI::App& app) {
              return app.add_option_function<std::string>(
                  "--flip-normal", [&s](const std::string& text) { read_flips(text, s.flip_normal); });
            });
  table.choice("--position-space", s.position_space,
               "the space of the positions; auto: the one that puts them onto their pixels");
  table.flag("--strict", s.strict, "what could only be guessed is an error");
  table.text("--camera", s.camera, "FILE.json", "the camera; see Cameras in the README");
  table.number("--fov", s.fov, "degrees", strictly_between(0, 180),
               "horizontal field of view, instead of a camera file");
  table.number("--focal", s.focal, "mm", above(0), "focal length, with --aperture, instead of a camera file");
  table.number("--aperture", s.aperture, "mm", above(0), "width of the film back");
  table.number("--ortho-width", s.ortho_width, "scene units", above(0),
               "width of an orthographic view, instead of a camera file");
}

void add_frame_rows(Table& table, RunOptions& options) {
  FrameSettings& s = options.settings.frames;
  table.group("Frames");
  table.text("--frames", s.frames, "LIST", "such as 1001-1100x2,1200; else those of INPUT on the disk");
  table.number("--output-offset", s.output_offset, "frames", between(-1e9, 1e9),
               "from the numbers of the inputs to those of the outputs");
  table.row("--chunk", "I/N", "", "I from 1 to N", "compute only this part of the frames", "", [&s](CLI::App& app) {
    return app.add_option_function<std::string>("--chunk", [&s](const std::string& text) { read_chunk(text, s); });
  });
  table.choice("--missing", s.missing, "what a frame without its input is: an error before any work, or left out");
  table.flag("--keep-going", s.keep_going, "a frame that fails does not end the run; the exit code is then 1");
  table.flag(
      "--resume", s.resume,
      "compute only frames whose outputs are missing, broken, older than their inputs or made with other options");
  table.flag(
      "--overwrite", s.overwrite,
      "compute all frames and replace their outputs, whatever --resume says; without --resume that is so anyway");
  table.row("--dry-run", "", "", "", "print frames, files and memory, and stop", "",
            [&options](CLI::App& app) { return app.add_flag("--dry-run", options.dry_run)->configurable(false); });
}

void add_estimator_rows(Table& table, RunOptions& options) {
  EstimatorSettings& s = options.settings.estimator;
  table.group("Estimator");
  table.row("--preset", "NAME|FILE", "", "", "settings from a preset; may repeat, later wins, options win over presets",
            "", [](CLI::App& app) {
              return app.set_config("--preset")
                  ->expected(1)
                  ->take_all()
                  ->transform([](const std::string& name) { return preset_file(name); })
                  ->description("");
            });
  table.choice("--estimator", s.estimator,
               "gtao: horizons; bitmask: what is blocked between front and back of every occluder; hbao: horizons, not "
               "cosine weighted; crytek: samples in the hemisphere");
  const Range reach = above_to(0, 1e18);
  table.row("--radius", "NUMBER", "scene units", reach.text,
            "how far occluders reach; must be given, here or in a preset. May repeat: the AO is the mean of all "
            "scales, see ao-scales",
            "", [&s, reach](CLI::App& app) {
              return app
                  .add_option_function<std::vector<double>>(
                      "--radius", [&s](const std::vector<double>& radii) { read_radii(radii, s); })
                  ->expected(1)
                  ->take_all()
                  ->allow_extra_args(false)
                  ->check(check_of(reach));
            });
  table.choice("--falloff", s.falloff, "how a hit's weight fades towards the radius; none: all within it block fully");
  table.number("--falloff-start", s.falloff_start, "of the radius", below_and_at_least(0, 1),
               "where the falloff begins");
  table.number("--falloff-end", s.falloff_end, "of the radius", above_to(0, 1),
               "where the falloff ends: nothing beyond blocks");
  table.number("--slices", s.slices, "a pixel", between(1, 64), "directions that are searched");
  table.number("--steps", s.steps, "a side", between(1, 4096), "samples to each side of a slice");
  table.choice("--search", s.search,
               "of gtao, along a slice; steps: as many samples as --steps; exact: all pixels, by the outlines of "
               "surfaces; every-pixel: the same one by one, slowly");
  table.number("--tolerance", s.tolerance, "", between(0, 1),
               "of gtao, RMS error of the AO by its search: as many directions of an exact search, tile by tile, as "
               "that takes, without a denoiser; 0: as many as --slices");
  table.number("--samples", s.samples, "a pixel", between(4, 64), "of crytek, in the hemisphere");
  table.number("--bias", s.bias, "", between(0, 1e18),
               "keeps a surface from blocking itself; crytek: scene units of depth; others: sine of the elevation "
               "above the surface, below 1");
  table.choice("--elevation", s.elevation,
               "of hbao; view: the horizon's less the surface's, above the plane across the view ray; surface: the "
               "horizon's above the surface");
  table.choice("--sample-kernel", s.sample_kernel,
               "of crytek; clustered: more samples near the receiver; uniform: even in volume");
  table.choice("--range-check", s.range_check,
               "of crytek, by the depth dz between receiver and hit; none: every hit counts fully; ratio: "
               "smoothstep(0, 1, radius / dz); smoothstep: 1 - smoothstep(0, radius, dz)");
  table.row("--thickness", "auto|infinite|NUMBER", "scene units", "",
            "how far an occluder goes on behind what is seen of it; auto: as deep as it is wide", "auto",
            [&s](CLI::App& app) {
              return app.add_option_function<std::string>("--thickness",
                                                          [&s](const std::string& text) { read_thickness(text, s); });
            });
  table.choice("--resolution", s.resolution,
               "of the estimate; a half or a quarter takes the nearest surface of every 2 x 2 or 4 x 4 pixels");
  table.row("--stride", "auto|1|2|4", "", "",
            "estimate one pixel of so many in a row, staggered, and let the bilateral denoiser give the others theirs; "
            "auto: 4 for gtao with 1 or 2 slices at full resolution, else 1",
            "auto", [&s](CLI::App& app) {
              return app
                  .add_option_function<std::string>(
                      "--stride", [&s](const std::string& text) { s.stride = text == "auto" ? 0 : std::stoi(text); })
                  ->check(CLI::IsMember({"auto", "1", "2", "4"}));
            });
  table.choice("--denoise", s.denoise,
               "smooths each surface: bilateral: by a Gaussian or --denoise-kernel; box: by an even 4 x 4");
  table.number("--denoise-radius", s.denoise_radius, "pixels of the estimate", between(1, 8),
               "how far the bilateral denoiser reaches to each side");
  table.row("--denoise-kernel", "W0,W1,...", "", "2 to 9 weights",
            "of the bilateral denoiser, from the centre outwards, of any sum; they set its radius", "",
            [&s](CLI::App& app) {
              return app.add_option_function<std::string>("--denoise-kernel",
                                                          [&s](const std::string& text) { read_kernel(text, s); });
            });
  table.number("--denoise-depth-sigma", s.denoise_depth_sigma, "of the depth", between(0, 100),
               "pixels that far apart weigh 1/e: exp(-|dz| / (SIGMA z)), z the nearer; 0: weighs by the distance from "
               "each other's plane");
  table.number("--intensity", s.intensity, "", between(0, 100), "factor on the occlusion");
  table.number("--power", s.power, "", above_to(0, 100), "exponent of the visibility");
  table.number("--fade-start", s.fade_start, "scene units", between(0, 1e30),
               "depth where the AO begins to fade to 1; with --fade-end");
  table.number("--fade-end", s.fade_end, "scene units", above_to(0, 1e30), "depth from which the AO is 1");
  table.number("--roughness", s.roughness, "", between(0, 1), "of all surfaces, for specular-occlusion");
  table.choice("--noise", s.noise,
               "fixed: every frame has the same pattern of sample noise, so that what stands still does not flicker; "
               "animated: one of its own");
  table.number("--seed", s.seed, "", between(0, 4294967295.0), "shifts the sample noise");
  table.flag("--no-skip", s.no_skip, "estimate sky too, and tiles that are proved to be open; slower, the same bits");
  table.number("--skip-tolerance", s.skip_tolerance, "", between(0, 0.1),
               "of gtao and bitmask: also leave out, as open, tiles whose AO, before --intensity and --power, is "
               "proved to be at least 1 less this, whatever the noise of few samples; 0: the same bits as --no-skip");
}

void add_output_rows(Table& table, OutputSettings& s) {
  table.group("Output");
  table.row("-o,--output", "FILE.exr", "", "", "the AO, 1 = open, and what else --aov names", "",
            [&s](CLI::App& app) { return app.add_option("-o,--output", s.output); });
  table.row("--aov", "LIST", "", "", fmt::format("what OUTPUT holds, with commas: {}", fmt::join(aov_names(), ", ")),
            s.aovs, [&s](CLI::App& app) { return app.add_option("--aov", s.aovs); });
  table.choice("--ao-channels", s.ao_channels, "mono: Y; rgb: R, G, B");
  table.choice("--aov-space", s.aov_space,
               "the space of the normals in OUTPUT; auto: world where the camera has world_to_camera, else view");
  table.flag("--multi-bounce", s.multi_bounce,
             "light between coloured surfaces brightens the rgb AO and the composite's indirect light; needs a diffuse "
             "colour");
  table.text("--composite", s.composite, "FILE.exr",
             "the beauty with AO in its ambient light, or in all of it where the parts are missing");
  table.number("--fog-density", s.fog_density, "1 / scene units", between(0, 1e30),
               "of exponential fog in the beauty, which hides the AO of what lies behind it");
  table.text("--preview", s.preview, "FILE.png", "a picture of the composite, or of the AO where there is none");
  table.text("--debug", s.debug, "LIST",
             fmt::format("pictures beside OUTPUT, ao.exr -> ao.VIEW.png, with commas: {}",
                         fmt::join(debug_view_names(), ", ")));
  table.choice("--type", s.type, "sample type of OUTPUT; depth is always float");
  table.word("--compression", s.compression, {"none", "rle", "zips", "zip", "piz"},
             "of the AO file; a composite keeps OpenEXR's zip");
  table.text("--ocio", s.ocio, "FILE",
             "OpenColorIO configuration for the preview; else the OCIO variable, else linear Rec.709 to sRGB");
}

void add_device_rows(Table& table, DeviceSettings& s) {
  table.group("Device");
  table.text("--device", s.device, "auto|cpu|INDEX|NAME|UUID", "where to compute; auto: the first GPU, else the CPU");
  table.flag("--require-gpu", s.require_gpu, "computing on the CPU is an error");
  table.flag("--validate", s.validate, "load the Vulkan validation layer; any message is an error");
  table.flag("--no-pipeline-cache", s.no_pipeline_cache, "keep no compiled kernels in the XDG cache folder");
  table.row("--memory", "SIZE", "bytes, or with K, M, G", "",
            "of the whole process; larger frames are computed in tiles; else half of what is free", "",
            [&s](CLI::App& app) {
              return app.add_option_function<std::string>(
                  "--memory", [&s](const std::string& text) { s.memory = read_size("--memory", text); });
            });
  table.number("--threads", s.threads, "", between(0, 1024),
               "threads of the CPU device and of the codecs; 0: one a core");
}

void add_report_rows(Table& table, RunOptions& options) {
  table.group("Reports");
  table.text("--stats", options.settings.output.stats, "FILE.json", "times of every pass, counts and totals");
  table.word("--progress", options.progress.kind, {"auto", "bar", "plain", "percent", "openjd", "none"},
             "plain: a line a frame; percent, openjd: on standard output, as farms read it; auto: a bar on a terminal, "
             "else plain");
  table.text("--log-json", options.settings.output.log_json, "FILE|-",
             "a JSON object a line for the beginning, every frame and the end");
  table.flag("-v,--verbose", options.progress.verbose, "say more: the time of every pass");
  table.flag("-q,--quiet", options.progress.quiet, "say nothing but errors");
  table.row("--print-config", "", "", "", "print the settings as a preset and stop", "", [&options](CLI::App& app) {
    return app.add_flag("--print-config", options.print_config)->configurable(false);
  });
}

std::string range_text(const OptionRow& row) {
  return row.unit + (row.unit.empty() || row.range.empty() ? "" : ", ") + row.range;
}

std::string help_text(const OptionRow& row) {
  const std::string range = range_text(row);
  return row.sentence + (range.empty() ? "" : " (" + range + ")");
}

/// Presets are read by a real TOML reader: CLI11's own stumbles over a '#', a comma or a space within quotes.
class PresetFormat : public CLI::ConfigTOML {
 public:
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> items;
    auto entries = parse_flat_toml(read_rest(input));
    if (input.bad()) fail(ErrorKind::input, "it cannot be read to its end");
    // The rules of presets/input are known to the program: such a preset is its --source and no more.
    if (std::ranges::any_of(entries, [](const auto& entry) { return entry.key == "detect"; }))
      std::erase_if(entries, [](const auto& entry) { return entry.key != "source"; });
    for (auto& entry : entries) {
      items.emplace_back();
      items.back().name = std::move(entry.key);
      items.back().inputs = std::move(entry.values);
    }
    return items;
  }
};

/// The app with the whole table; help shows unit or words where CLI11 would show a type.
std::unique_ptr<CLI::App> make_app(RunOptions& options) {
  auto app = std::make_unique<CLI::App>(
      "Computes ambient occlusion from the depth and normals of a rendered frame.\n\n"
      "Examples:\n"
      "  alcove run frame.exr -o ao.exr --camera camera.json --radius 0.5\n"
      "  alcove run frame.%04d.exr -o ao.%04d.exr --frames 1001-1100 --camera camera.json --radius 0.5 --resume\n"
      "  alcove run frame.exr --beauty beauty.exr -o ao.exr --composite out.exr --fov 60 --radius 0.5 --preset "
      "production\n",
      "alcove run");
  app->config_formatter(std::make_shared<PresetFormat>());
  app->allow_config_extras(CLI::config_extras_mode::error);
  app->get_formatter()->column_width(34);
  app->add_option("INPUT", options.settings.input.input,
                  "an EXR file with depth and normals, or a pattern such as frame.%04d.exr")
      ->configurable(false)
      ->type_name("");
  for (const auto& row : option_table(options)) {
    CLI::Option* option = row.add(*app);
    option->group(row.group)->description(help_text(row));
    if (!row.value.empty()) option->type_name(row.value);
    if (!row.default_text.empty()) option->default_str(row.default_text);
  }
  return app;
}

/// A configuration as CLI11 prints it, without the options that have no value (`name=""` means "not set" to CLI11
/// only), and with numbers as they are printed again when it is read as a preset.
std::string set_lines_of(const std::string& config) {
  std::istringstream lines(config);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find('=');
    if (equals == line.npos || line.ends_with("=\"\"") || line.ends_with("=false")) continue;
    double number = 0;
    const bool is_number = CLI::detail::lexical_cast(line.substr(equals + 1), number);
    text += is_number ? fmt::format("{}={}\n", line.substr(0, equals), number) : line + "\n";
  }
  return text;
}

/// Parses a preset by itself, so that what is wrong with it is said with its name.
void require_good_preset(const std::string& preset) {
  RunOptions options;
  const auto app = make_app(options);
  try {
    parse_arguments(*app, {"--preset", preset});
  } catch (const Error& error) {
    fail(error.kind(), "{} (--preset): {}", preset, error.what());
  }
}

}  // namespace

std::vector<OptionRow> option_table(RunOptions& options) {
  Table table;
  add_input_rows(table, options.settings.input);
  add_frame_rows(table, options);
  add_estimator_rows(table, options);
  add_output_rows(table, options.settings.output);
  add_device_rows(table, options.settings.device);
  add_report_rows(table, options);
  return table.rows;
}

std::string option_table_markdown() {
  RunOptions options;
  std::string text, group;
  const auto cell = [](std::string value) {  // a bar ends a cell
    for (std::size_t at = 0; (at = value.find('|', at)) != value.npos; at += 2) value.insert(at, "\\");
    return value;
  };
  for (const auto& row : option_table(options)) {
    if (row.group != group)
      text +=
          fmt::format("{}| {} | unit, range | default | |\n|---|---|---|---|\n", group.empty() ? "" : "\n", row.group);
    group = row.group;
    text += fmt::format("| `{}`{} | {} | {} | {} |\n", row.name, row.value.empty() ? "" : " " + cell(row.value),
                        cell(range_text(row)), row.default_text, cell(row.sentence));
  }
  return text;
}

bool parse_run_options(const std::vector<std::string>& arguments, RunOptions& options) {
  if (arguments == std::vector<std::string>{"--help-markdown"}) {
    fmt::print("{}", option_table_markdown());
    return false;
  }
  const auto app = make_app(options);
  try {
    if (!parse_arguments(*app, arguments)) return false;
  } catch (const Error&) {
    for (const auto& preset : app->get_config_ptr()->results()) require_good_preset(preset);
    throw;
  }
  if (options.print_config) {
    fmt::print("{}", set_lines_of(app->config_to_str(true, false)));
    return false;
  }
  return true;
}

}  // namespace alcove
