// What is made before the first frame is what frames need.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/compute.h"
#include "core/chain/results/outputs.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::warm_up_test {
namespace {

using namespace test;

TEST(WarmUp, makes_every_kernel_that_a_frame_runs_and_each_once) {
  Scene scene;
  scene.primitives = {parallelogram({-2, -1, -6}, {4, 0, 0}, {0, 0, 4}),
                      parallelogram({-2, -1, -6}, {0, 3, 0}, {4, 0, 0})};
  const HostFrame frame = render(scene, Shot::perspective({0, 0, 0}, {0, 0, -1}, 60, 96, 64)).frame;
  for (const char* preset : {"draft", "standard", "production", "reference"}) {
    const EstimatorSettings settings = test::preset(preset, 0.5);
    const WarmUp warm_up(device(), settings, {}, 0);
    std::set<std::string> made;
    for (const auto& name : warm_up.names()) made.insert(name.first);
    EXPECT_EQ(std::set(warm_up.names().begin(), warm_up.names().end()).size(), warm_up.names().size()) << preset;
    EXPECT_EQ(compute_ao(recorder(), frame, settings).ao.size(), frame.data.pixels());
    for (const auto& pass : recorder().passes()) EXPECT_TRUE(made.contains(pass.name)) << preset << ": " << pass.name;
  }
}

TEST(WarmUp, makes_what_shadows_of_lights_need) {
  OutputSettings output;
  output.lights = "lights.json";
  output.read_lights = lights_of(R"({"lights": [
    {"name": "hard", "kind": "sun", "direction": [1, 0, 0]},
    {"name": "soft", "kind": "point", "position": [1, 0, 0], "radius": 1}]})",
                                 output.lights);
  const auto made = [](const OutputSettings& wanted) {
    const WarmUp warm_up(device(), preset("standard", 0.5), wanted, 0);
    return std::ranges::count(warm_up.names(), "shadow", &gpu::KernelName::first);
  };
  EXPECT_EQ(made(output), 2);
  EXPECT_EQ(made({}), 0);
}

TEST(WarmUp, begins_with_what_has_the_most_code) {
  const WarmUp warm_up(device(), preset("standard", 0.5), {}, 0);
  ASSERT_FALSE(warm_up.names().empty());
  EXPECT_EQ(warm_up.names().front().first, "horizon");
}

TEST(WarmUp, of_all_presets_of_steps_can_do_with_the_twin_of_the_search) {
  const gpu::Reflection all = gpu::reflect(gpu::kernel_code("horizon"));
  for (const char* name : {"standard", "production"}) {
    const WarmUp warm_up(device(), preset(name, 0.5), {}, 0);
    const auto search = std::ranges::find(warm_up.names(), "horizon", &gpu::KernelName::first);
    ASSERT_NE(search, warm_up.names().end()) << name;
    EXPECT_EQ(gpu::code_for("horizon", all, search->second).data(), gpu::kernel_code("horizon_usual").data()) << name;
    for (const std::size_t id : {2, 4}) {
      std::vector<std::uint32_t> other = search->second;
      other.at(id)++;
      EXPECT_EQ(gpu::code_for("horizon", all, other).data(), gpu::kernel_code("horizon").data()) << name << ": " << id;
    }
  }
}

}  // namespace
}  // namespace alcove::warm_up_test
