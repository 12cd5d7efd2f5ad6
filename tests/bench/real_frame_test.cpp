// On a rendered frame AO without normals is near AO with them. What presets make of rendered frames against Cycles'
// ray-traced AO, `preset_limits` measures.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"

namespace alcove::real_frame_test {
namespace {

using namespace test;

TEST(RealFrame, normals_from_depth_come_close_to_the_rendered_ones) {
  HostFrame frame = rendered_frame("colonnade");
  const EstimatorSettings settings = sampled(Estimator::gtao, 0.75, 8, 16);
  const auto with_normals = ao_of(frame, settings);
  frame.normal.clear();
  // measured 0.0718; the rendered normals are smooth over facets
  EXPECT_LE(difference(ao_of(frame, settings), with_normals).rmse, 0.08);
}

}  // namespace
}  // namespace alcove::real_frame_test
