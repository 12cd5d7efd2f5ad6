// Prepares a frame, puts a visibility beside it, and records one pass.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/single_pass.h"

#include "core/chain/filters/filters.h"
#include "tests/support/device.h"

namespace alcove::test {
namespace {

std::size_t index_of(int x, int y, int width) { return std::size_t(y) * std::size_t(width) + std::size_t(x); }

gpu::Buffer& visibility(const std::vector<float>& values) {
  gpu::Buffer& buffer = recorder().buffer("visibility of a test", values.size() * sizeof(float), gpu::Use::upload);
  std::ranges::copy(values, buffer.as<float>().begin());
  recorder().upload(buffer);
  return buffer;
}

FrameInputs uploaded(const HostFrame& frame) {
  const FrameInputs inputs = upload(recorder(), frame);
  return inputs;
}

std::vector<float> finished(const gpu::Buffer& result) {
  recorder().download(result);
  recorder().run();
  const auto values = result.as<float>();
  return {values.begin(), values.end()};
}

}  // namespace

std::vector<float> denoised(const HostFrame& frame, const std::vector<float>& ao, const EstimatorSettings& settings) {
  const FrameInputs inputs = uploaded(frame);
  const GBuffer gbuffer = prepare(recorder(), inputs);
  reconstruct(recorder(), gbuffer);
  return finished(denoise(recorder(), gbuffer, visibility(ao), denoiser_of(settings)));
}

std::vector<float> upsampled(const HostFrame& frame, const std::function<double(int, int)>& ao_of_block,
                             const EstimatorSettings& settings) {
  const FrameInputs inputs = uploaded(frame);
  const GBuffer gbuffer = prepare(recorder(), inputs);
  reconstruct(recorder(), gbuffer);
  const GBuffer low = downsample(recorder(), gbuffer, block_grid(inputs, int(settings.resolution)));
  std::vector<float> ao;
  for (int y = 0; y < low.view.size.y; y++)
    for (int x = 0; x < low.view.size.x; x++) ao.push_back(float(ao_of_block(x, y)));
  return finished(upsample(recorder(), gbuffer, low, visibility(ao)));
}

Rendering furnished_room(int width, int height) {
  const Scene scene{{parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 1.5}),
                     Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5},
                     parallelogram({2, -1.5, 0.3}, {0.6, 0.2, 0.1}, {0, 0.9, 0})}};
  return render(scene, Shot::perspective({4.5, -1.5, 2.4}, {1, 0, 0.6}, 55, width, height));
}

std::vector<float> mirrored(const std::vector<float>& plane, const HostFrame& frame, bool left_right) {
  const int width = frame.data.width, height = frame.data.height;
  std::vector<float> result;
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      result.push_back(plane[left_right ? index_of(width - 1 - x, y, width) : index_of(x, height - 1 - y, width)]);
  return result;
}

HostFrame mirrored(const HostFrame& frame, bool left_right) {
  HostFrame result = frame;
  const std::size_t pixels = frame.data.pixels();
  result.depth = mirrored(frame.depth, frame, left_right);
  for (std::size_t axis = 0; axis < 3; axis++) {
    const auto from = frame.normal.begin() + std::ptrdiff_t(axis * pixels);
    std::vector<float> plane = mirrored({from, from + std::ptrdiff_t(pixels)}, frame, left_right);
    if (axis == (left_right ? 0 : 1)) std::ranges::transform(plane, plane.begin(), std::negate());
    std::ranges::copy(plane, result.normal.begin() + std::ptrdiff_t(axis * pixels));
  }
  (left_right ? result.camera.cx : result.camera.cy) =
      left_right ? frame.data.width - frame.camera.cx : frame.data.height - frame.camera.cy;
  return result;
}

HostFrame scaled(HostFrame frame, int exponent) {
  for (auto* depths : {&frame.depth, &frame.behind_depth})
    for (float& z : *depths) z = std::ldexp(z, exponent);
  if (frame.camera.orthographic)
    frame.camera.fx = std::ldexp(frame.camera.fx, -exponent), frame.camera.fy = std::ldexp(frame.camera.fy, -exponent);
  frame.sky = std::ldexp(frame.sky, exponent);
  return frame;
}

HostFrame random_bits(int width, int height, unsigned seed) {
  HostFrame frame = furnished_room(width, height).frame;
  std::mt19937 random(seed);
  for (auto* plane : {&frame.depth, &frame.normal})
    for (float& value : *plane)
      if (random() % 3) value = std::bit_cast<float>(std::uint32_t(random()));
  return frame;
}

}  // namespace alcove::test
