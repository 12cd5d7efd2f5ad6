// The difference between a result and a reference, in numbers: pure functions on planes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace alcove {

/// The values of one plane, row by row, or of several planes, one behind the other.
using Values = std::span<const float>;
/// A mask: one value per pixel of a plane, not 0 if the pixel counts; empty: all count. It holds for each of several
/// planes.
using Mask = std::span<const std::uint8_t>;

/// The errors of a plane. The error of a value is result - reference. All sums are in double.
struct PlaneErrors {
  std::size_t count = 0;  // values that were compared
  // values left out because one of the two is NaN or infinite; values that the mask leaves out do not count here
  std::size_t excluded = 0;
  double rmse = 0, mae = 0;
  double bias = 0;          // the mean error: positive if the result is too bright
  double max = 0;           // of the error's size, as are the percentiles
  double p95 = 0, p99 = 0;  // interpolated linearly between the two nearest ranks
};

/// Measures the errors. With a `reference_b`, whose noise is independent of the reference's, the reference is the mean
/// of the two, and rmse is free of their noise: if noise in a and b has the mean 0, sqrt(max(0, mean((t - a)(t - b))))
/// is the RMSE of t against the value that both estimate. Fails with ErrorKind::input if no value is left to compare.
PlaneErrors compare_planes(Values result, Values reference, Mask mask = {}, Values reference_b = {});

/// 20 log10(peak / rmse), in dB; infinite for an rmse of 0.
double psnr(double rmse, double peak = 1);

/// A value that is NaN or infinite in the result or in the reference, and finite in the other one.
struct Hole {
  std::size_t value = 0;  // its index in the planes
  bool in_result = false;
};

/// Planes for measures that look at neighbourhoods too (ssim, FLIP). They are finite, and equal at pixels that do not
/// count, so that such a pixel adds no error to its neighbours.
struct Comparable {
  std::vector<float> result, reference, reference_b;  // reference_b: empty without a second reference
  std::vector<std::uint8_t> mask;                     // one per pixel; 1: all its values are compared
  std::size_t count = 0;                              // compared pixels
  std::size_t excluded = 0;                           // pixels within the mask that a NaN or an infinity leaves out
  std::size_t masked = 0;                             // pixels that the mask leaves out
  std::size_t holes = 0;                              // of the excluded: see Hole
  std::optional<Hole> first_hole = {};

  /// The reference, or the mean of both references.
  std::vector<float> mean_reference() const;
};

/// Prepares planes. `pixels` is the size of one plane; `what` begins the message. Fails with ErrorKind::input if no
/// pixel is left.
Comparable make_comparable(const std::string& what, std::size_t pixels, Values result, Values reference,
                           Values reference_b, Mask mask);

/// The structural similarity (Wang et al. 2004): Gaussian window of 11 x 11, sigma 1.5, K1 .01, K2 .03, dynamic range
/// `peak`. It is the mean over the planes, and over the pixels that count and are at least 5 from every border; nothing
/// if there is no such pixel. All values must be finite. It equals
/// skimage.metrics.structural_similarity(gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
/// data_range=peak).
std::optional<double> ssim(int width, int height, Values result, Values reference, Mask mask = {}, double peak = 1);

/// The errors of some of the values; rmse and bias are 0 if there are none.
struct PartErrors {
  std::size_t count = 0;
  double rmse = 0, bias = 0;
};

struct BandErrors {
  double from = 0, to = 0;  // from <= reference < to; the outermost bands take values beyond them too
  PartErrors errors;
};

/// Measures the errors by darkness of the reference: [0, .25), [.25, .5), [.5, .75), [.75, 1]. Like compare_planes(),
/// but bands may be empty.
std::array<BandErrors, 4> darkness_bands(Values result, Values reference, Mask mask = {}, Values reference_b = {});

/// The step between neighbours that is an edge, as a part of the nearer depth.
inline constexpr double kDepthStep = 0.1;
/// The distance in px, in x and in y, up to which a pixel is at the edge of a step between two pixels.
inline constexpr int kEdgeReach_px = 2;

/// Marks depth edges with 1. Depth is planar and positive. Values that are not finite, not positive, or at least `sky`
/// are sky, which makes a step to any surface.
std::vector<std::uint8_t> depth_edges(int width, int height, Values depth, double sky);
/// Marks surfaces with 1.
std::vector<std::uint8_t> surfaces(Values depth, double sky);

/// Errors at depth edges and away from them; either part may be empty.
struct EdgeErrors {
  PartErrors at, away;
};
EdgeErrors edge_errors(Mask edges, Values result, Values reference, Mask mask = {}, Values reference_b = {});

/// A plain pixel is the middle of a square of plain surface that reaches so far to each side: 15 x 15 pixels.
inline constexpr int kPlainReach_px = 7;
/// A surface bends where the second difference of 1/z along x or along y is this part of 1/z or more.
inline constexpr double kPlainBend = 1e-4;

/// Gives 1 at plain pixels: all 15 x 15 pixels about such a pixel lie in the picture, are surfaces, count by the mask,
/// and do not bend. Depth and sky are as for depth_edges().
///
/// In a perspective 1/z is affine over the picture on every plane, and a pixel at the picture's border has no second
/// difference. The camera is not asked for: an orthographic one sees planes as affine z, and then a tilted plane passes
/// where its 1/z bends less than the bound. Depth that was rounded to half floats shows hardly any plain pixel.
std::vector<std::uint8_t> plain_pixels(int width, int height, Values depth, double sky, Mask mask = {});

/// The RMS of the error's high-pass residual over the plain pixels and over the planes. The residual of a pixel is its
/// error less the mean error of the 15 x 15 pixels about it: stripes and specks count, a bias or a soft gradient does
/// not. With a second reference it is the root of the mean product of the residuals against the one and the other, 0
/// where that is negative: independent noise of the references drops out. All values must be finite. Nothing where no
/// pixel is plain.
std::optional<double> grain(int width, int height, Mask plain, Values result, Values reference,
                            Values reference_b = {});

/// A smooth pixel is the middle of a square without edges that reaches so far to each side. An edge is no surface, or
/// bends by this or more, or turns its normal against the left or the upper neighbour's to this cosine or less.
inline constexpr int kSmoothReach_px = 2;
inline constexpr double kSmoothBend = 1e-3, kSmoothCosine = 0.98;
/// In half shadow the truth is between these bounds, as a mean over the smooth pixels up to so far to each side.
inline constexpr int kShadowReach_px = 4;
inline constexpr double kShadowFrom = 0.2, kShadowTo = 0.97;

/// Gives 1 at smooth pixels in half shadow. `normal` has planes of x, y and z, of unit length; empty: depth alone tells
/// edges. Depth, sky and border are as for plain_pixels(). A truth that is not finite leaves out the pixels about it.
std::vector<std::uint8_t> half_shadow(int width, int height, Values depth, double sky, Values normal, Values truth);

/// The RMS, over the pixels in half shadow, of the standard deviation (n - 1) between results that differ in their
/// seed: clouds and beads that noise leaves. Pixels with a value that is not finite are left out; nothing where none is
/// left.
std::optional<double> mottle(Mask half, std::span<const std::vector<float>> results);

// Separable filters, in double precision.

/// Correlates the plane (width x height, row by row) with `along_x` in its rows, then with `along_y` in its columns.
/// Kernels have an odd number of weights; the middle one is for the pixel itself. Outside, the border's pixels are
/// repeated.
std::vector<double> convolve(int width, int height, std::span<const double> plane, std::span<const double> along_x,
                             std::span<const double> along_y);

/// The weights exp(-x^2 / (2 sigma^2)) for x from -radius to radius, with sum 1. Both are in pixels and above 0.
std::vector<double> gaussian_kernel(double sigma, int radius);

// Flicker: the change of a sequence's error from frame to frame.

/// The errors of one frame of a sequence. All planes are of one size, row by row.
struct ErrorFrame {
  int width = 0, height = 0;
  std::vector<float> error;        // result - reference; one or several planes
  std::vector<float> error_b;      // result - a second, independently noisy reference; empty without one
  std::vector<std::uint8_t> mask;  // one per pixel; 0: does not count
  std::vector<float> depth;        // empty: unknown
  // The place in the previous frame minus the place here, in pixels, y up (as Blender's Vector); empty: nothing moves.
  std::vector<float> motion_x, motion_y;
};

/// The root mean square of error(here) - error(previous frame, same surface). It is 0 for an error that stays on its
/// surface, and for any movement that the reference makes too. With two references, it is free of their noise, as in
/// compare_planes().
///
/// With motion, the same surface is at the pixel nearest to the motion's place. Its value is not interpolated, since
/// that would hide noise. A pixel is left out if it or its earlier place does not count or lies outside, if the motion
/// is not finite, and if the two depths differ by more than kDepthStep.
class Flicker {
 public:
  /// Adds two consecutive frames, of one size and with the same planes.
  void add(const ErrorFrame& previous, const ErrorFrame& here);
  std::size_t count() const { return count_; }
  /// The flicker; 0 if nothing was added.
  double rms() const;

 private:
  double square_ = 0;
  std::size_t count_ = 0;
};

/// Planes of red, green and blue, of one size, row by row, all finite. For grey, use the same plane three times.
using ColorPlanes = std::array<std::span<const float>, 3>;

/// The FLIP error of every pixel, in [0, 1], of display values (sRGB-encoded, clamped to [0, 1]), as seen by the
/// papers' default viewer, with 67 pixels per degree. Symmetric in the two images.
std::vector<float> ldr_flip(int width, int height, const ColorPlanes& result, const ColorPlanes& reference);

/// The exposures of HDR-FLIP, in stops: from that where the brightest reference pixel is just below white to that where
/// the median is.
struct ExposureRange {
  double start = 0, stop = 0;
  int count = 2;  // the larger of 2 and the number of stops
};
ExposureRange hdr_flip_exposures(const ColorPlanes& reference);

/// The HDR-FLIP error of every pixel, in [0, 1], of scene-linear Rec.709 values (clamped to [0, 65536]): the largest
/// LDR-FLIP over the exposures, each after the ACES tone curve. Not symmetric: the exposures are the reference's.
std::vector<float> hdr_flip(int width, int height, const ColorPlanes& result, const ColorPlanes& reference);

}  // namespace alcove
