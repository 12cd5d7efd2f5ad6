// How far a result is from a reference, in numbers: pure functions on planes.
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

/// Values of one plane, row by row; or of several planes, one behind the other.
using Values = std::span<const float>;
/// Not 0 where a pixel counts; if it is empty, all do. It is of one plane; where the values are several planes, it
/// holds for each of them.
using Mask = std::span<const std::uint8_t>;

/// All sums are in double. The error of a value is result - reference.
struct PlaneErrors {
  std::size_t count = 0;  // values that were compared
  // values left out because one of the two is NaN or infinite; what the mask leaves out is not among them
  std::size_t excluded = 0;
  double rmse = 0, mae = 0;
  double bias = 0;          // the mean error: positive where the result is too bright
  double max = 0;           // of the error's size, as are the percentiles
  double p95 = 0, p99 = 0;  // interpolated linearly between the two nearest ranks
};

/// Measures the errors. Fails with ErrorKind::input if no value is left to compare. With a `reference_b`, whose noise
/// is independent of the reference's, the reference is the mean of the two and rmse is free of their noise:
/// sqrt(max(0, mean((t - a)(t - b)))) is, with noise in a and b of mean 0, the RMSE of t against what both estimate.
PlaneErrors compare_planes(Values result, Values reference, Mask mask = {}, Values reference_b = {});

/// 20 log10(peak / rmse), in dB; infinite for an rmse of 0.
double psnr(double rmse, double peak = 1);

/// Planes made ready for measures that look at neighbourhoods too (ssim, FLIP): they are finite, and equal where a
/// pixel does not count, so that such a pixel adds no error to its neighbours.
struct Comparable {
  std::vector<float> result, reference, reference_b;  // reference_b: empty where there is none
  std::vector<std::uint8_t> mask;                     // one per pixel; 1 where all its values are compared
  std::size_t count = 0;                              // pixels that are compared
  std::size_t excluded = 0;  // pixels that the mask leaves in and a NaN or an infinity leaves out
  std::size_t masked = 0;    // pixels that the mask leaves out

  /// The reference, or the mean of the two.
  std::vector<float> mean_reference() const;
};

/// `pixels` is the size of one plane. Fails with ErrorKind::input when no pixel is left; `what` begins the message.
Comparable make_comparable(const std::string& what, std::size_t pixels, Values result, Values reference,
                           Values reference_b, Mask mask);

/// Structural similarity (Wang et al. 2004): Gaussian window of 11 x 11, sigma 1.5, K1 .01, K2 .03, dynamic range
/// `peak`; the mean over the pixels that count and are at least 5 from every border, and over the planes. All values
/// must be finite. Nothing where no such pixel is. The same as
/// skimage.metrics.structural_similarity(gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
/// data_range=peak).
std::optional<double> ssim(int width, int height, Values result, Values reference, Mask mask = {}, double peak = 1);

/// The errors of some of the values; rmse and bias are 0 where there are none.
struct PartErrors {
  std::size_t count = 0;
  double rmse = 0, bias = 0;
};

struct BandErrors {
  double from = 0, to = 0;  // from <= reference < to; the outermost bands take what is beyond them
  PartErrors errors;
};

/// Measures the errors by darkness of the reference: [0, .25), [.25, .5), [.5, .75), [.75, 1]. It is like
/// compare_planes(), but bands may be empty.
std::array<BandErrors, 4> darkness_bands(Values result, Values reference, Mask mask = {}, Values reference_b = {});

/// A step between neighbours of more than this part of the nearer depth is an edge.
inline constexpr double kDepthStep = 0.1;
/// A pixel is at an edge when one of the step's two pixels is at most this far from it in x and in y.
inline constexpr int kEdgeReach_px = 2;

/// Gives 1 at depth edges. Depth is planar and positive; at or beyond `sky`, and where it is not finite or not
/// positive, it is sky: a step to any surface.
std::vector<std::uint8_t> depth_edges(int width, int height, Values depth, double sky);
/// Gives 1 where there is a surface.
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

// Separable filters, in double precision.

/// Correlates the plane (width x height, row by row) with `along_x` in its rows, then with `along_y` in its columns.
/// The kernels have an odd number of weights, the middle one for the pixel itself. Outside, the border's pixels are
/// repeated.
std::vector<double> convolve(int width, int height, std::span<const double> plane, std::span<const double> along_x,
                             std::span<const double> along_y);

/// exp(-x^2 / (2 sigma^2)) for x from -radius to radius, sum 1. Units: pixels, both above 0.
std::vector<double> gaussian_kernel(double sigma, int radius);

// Flicker: how much the error of a sequence changes from frame to frame.

/// The errors of one frame of a sequence. All planes are of one size, row by row.
struct ErrorFrame {
  int width = 0, height = 0;
  std::vector<float> error;        // result - reference; one or several planes
  std::vector<float> error_b;      // result - a second, independently noisy reference; empty where there is none
  std::vector<std::uint8_t> mask;  // one per pixel; 0 where it does not count
  std::vector<float> depth;        // empty: not known
  // The place in the previous frame minus the place here, in pixels, y up (as Blender's Vector); empty: nothing moves.
  std::vector<float> motion_x, motion_y;
};

/// The root mean square of error(here) - error(previous frame, same surface): 0 for an error that stays where it is on
/// a surface, and for any movement that the reference makes too. With two references it is free of their noise, as
/// that of compare_planes() is.
///
/// With motion, the same surface is at the pixel that is nearest to the motion's place. That pixel is taken as it is,
/// since interpolation would hide noise. A pixel is left out where it or its earlier place does not count or is
/// outside, where the motion is not finite, and where the two depths differ by more than kDepthStep.
class Flicker {
 public:
  /// Adds two consecutive frames, of one size and with the same planes.
  void add(const ErrorFrame& previous, const ErrorFrame& here);
  std::size_t count() const { return count_; }
  /// 0 where nothing was added.
  double rms() const;

 private:
  double square_ = 0;
  std::size_t count_ = 0;
};

/// Pixels per degree of the viewer's sight: the papers' default, a 0.7 m wide 4K monitor seen from 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67;

/// Red, green, blue: planes of one size, row by row, all finite. For grey, the same plane three times.
using ColorPlanes = std::array<std::span<const float>, 3>;

/// The error of every pixel, in [0, 1], of display values (sRGB-encoded, clamped to [0, 1]). Symmetric in the two
/// images.
std::vector<float> ldr_flip(int width, int height, const ColorPlanes& result, const ColorPlanes& reference,
                            double pixels_per_degree = kFlipPixelsPerDegree);

/// The exposures, in stops, between which HDR-FLIP looks: from where the brightest reference pixel is just below white
/// to where the median is.
struct ExposureRange {
  double start = 0, stop = 0;
  int count = 2;  // the larger of 2 and the number of stops
};
ExposureRange hdr_flip_exposures(const ColorPlanes& reference);

/// The error of every pixel, in [0, 1], of scene-linear Rec.709 values (clamped to [0, 65536]): the largest LDR-FLIP of
/// the exposures, each after the ACES tone curve. Not symmetric: the exposures are the reference's.
std::vector<float> hdr_flip(int width, int height, const ColorPlanes& result, const ColorPlanes& reference,
                            double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace alcove
