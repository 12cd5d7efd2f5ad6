// Every other device of this machine gives the AO that the tests' device gives, to an RMSE of 1e-4.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bench/stability/cases.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::devices_test {
namespace {

using namespace test;

TEST(Devices, agree) {
  int others = 0;
  for (const auto& info : gpu::list_devices()) {
    if (!info.unusable.empty() || info.uuid == device().info().uuid) continue;
    others++;
    gpu::Device other(gpu::DeviceOptions{.choice = info.uuid});
    gpu::Recorder on_other(other);
    for (const Spec& spec :
         {Spec{.width = 320, .height = 240}, Spec{.scale = 1e6, .fov = 120, .width = 320, .height = 240}}) {
      const Case made = test::made(spec);
      for (const auto& variant : variants()) {
        const EstimatorSettings settings = with_radius(variant.settings, made.radius);
        const Difference d =
            difference(compute_ao(on_other, made.frame, settings).ao, compute_ao(recorder(), made.frame, settings).ao);
        EXPECT_LE(d.rmse, 1e-4) << info.name << ", " << variant.name << ": " << to_string(spec) << ", "
                                << place(d, made.frame);
      }
    }
  }
  if (!others) GTEST_SKIP() << "there is one device only";
}

}  // namespace
}  // namespace alcove::devices_test
