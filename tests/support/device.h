// One device for a whole test program: making one takes longer than most tests.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/gpu/recorder.h"
#include "tests/support/test.h"

namespace alcove::test {

/// The device that ALCOVE_TEST_DEVICE names, else `auto`; with the validation layer where ALCOVE_TEST_VALIDATE is set.
/// Its buffers are guarded, so the host sees them; where ALCOVE_TEST_STAGED is set they lie in memory that it does not
/// see, without guards.
gpu::Device& device();
/// A recorder on it.
gpu::Recorder& recorder();
/// A buffer of the recorder with these values.
template <class T>
gpu::Buffer& given(std::string_view name, const std::vector<T>& values, gpu::Recorder& gpu = recorder()) {
  gpu::Buffer& buffer = gpu.buffer(name, values.size() * sizeof(T), gpu::Use::upload);
  std::ranges::copy(values, buffer.as<T>().begin());
  gpu.upload(buffer);
  return buffer;
}
/// What a buffer holds once all that is recorded has run.
template <class T>
std::vector<T> downloaded(const gpu::Buffer& buffer, gpu::Recorder& gpu = recorder()) {
  gpu.download(buffer);
  gpu.run();
  const auto values = buffer.as<T>();
  return {values.begin(), values.end()};
}
/// GTAO and no more: every pixel by itself, occluders solid as far as the radius.
EstimatorSettings plain_settings();

}  // namespace alcove::test
