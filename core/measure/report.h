// The self-contained page of `alcove bench`, `alcove compare --report` and `alcove wedge`: chart, table, pictures.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace alcove {

/// Makes one HTML file that fetches nothing: styles, scripts and libraries (report/) are inside, and so is `json`.
///
/// `json` is valid JSON in UTF-8, as json_text() makes it.
/// Every string may be hostile: the page shows strings as text only. Members, all needed unless said otherwise:
///
///   "title"         string
///   "kind"          "compare", "bench" or "wedge"; this one has a card of each candidate instead of the table
///   "device"        string or null
///   "yardstick_ms"  number or null: the time of a yardstick; times can then also be read in yardsticks
///   "candidates"    list of {"name": string, unique, "settings": string, "ms": number or null,
///                   "ms_min": number or null, "rmse": number, and any more numbers such as "p99", "bias"}: means over
///                   the frames. With a time and an RMSE a candidate is a point of the chart; without such a candidate
///                   the page has no chart. Of a wedge, "settings" is the command, without "rmse"; it adds "radius", in
///                   scene units, and "notes", a list of strings.
///   "rows"          list of {"frame": string, "candidate": a candidate's name, and numbers or nulls: "ms", "ms_min",
///                   "rmse", "p99", "bias", "estimator_rmse", "geometry_rmse", "samples_per_pixel", ..., and optional
///                   "fails": bool, of a frame that breaks a limit}: the table. A
///                   column is shown when any row has a number for it; columns that the page does not know come last
///                   and are headed by their key.
///   "images"        list, may be empty, of {"frame": string, "candidate": string, "width": pixels, "height": pixels,
///                   "result": PICTURE, "truth": PICTURE, "error": PICTURE or null}. PICTURE is a
///                   "data:image/png;base64,..." URL; all three are of one size. "truth" may be null or absent where
///                   another image of the same frame has it, so that a frame's truth is stored once. "error" is
///                   result - truth in the colours of error_png(), which the page's legend explains, with an
///                   error of "full" in the strongest, else of kFullColorError. "composite" is optional: a PICTURE or
///                   null.
///   "verdict"       optional, or null: {"pass": bool, "limits": list of {"option": string, "limit": number, "value":
///                   number or null, "frame": string, "holds": bool}, and optional "failed": list of {"frame": string,
///                   "error": string}, of frames that were not compared}: shown above all
///   "sequence"      optional, or null: {"worst_frame": string, "worst_rmse": number, "mean_rmse": number, and of
///                   frames that follow each other "flicker": number or null}: measures as a whole, above the table
///   "frames"        optional list of {"name": string, "yardstick_ms": number or null}: a frame's own yardstick, where
///                   frames differ in size; "yardstick_ms" above is then their mean. For the circle of a radius around
///                   the pointer it adds "scale": {"depth": PICTURE, 0 for sky, else 1 + 254 log(z / near) / log(far /
///                   near), "near", "far", "tangents": of a pixel in x and y, or scene units where "orthographic"}
///
/// Numbers that are not finite must be null, as JSON has no others.
std::string report_page(const std::string& json);

// Pictures for the page: planes as "data:image/png;base64,..." URLs.

/// The error with full colour where many pictures share a scale: blue if the result is too dark, red if it is too
/// bright. An error of 0 is white.
inline constexpr float kFullColorError = 0.25f;

/// Shows width x height values in [0, 1]: of 1 channel as grey, unconverted, since AO is data; of 3 as interleaved r,
/// g, b display values.
std::string picture_url(int width, int height, int channels, std::span<const float> values);
/// The bytes of a PNG that shows result - reference in colours, an error of `full` in the strongest; grey if the
/// difference is not finite.
std::string error_png(int width, int height, std::span<const float> result, std::span<const float> reference,
                      float full = kFullColorError);
/// The URL of a PNG with these bytes.
std::string url_of_png(std::span<const char> png);

/// The page with the mark "{{report.json}}" in place of the JSON; cmake/embed_report.cmake checks it.
std::string_view report_template();

}  // namespace alcove
