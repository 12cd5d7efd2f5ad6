// Tells NaN and infinity by their bits, since drivers without SignedZeroInfNanPreserve may take isnan and isinf for
// false. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

bool is_finite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }
bool is_nan(float x) { return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u; }
