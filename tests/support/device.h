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
/// GTAO and no more: every pixel by itself, occluders solid as far as the radius.
EstimatorSettings plain_settings();

}  // namespace alcove::test
