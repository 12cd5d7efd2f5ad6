// Depths as keys that grow while a nearer one is sought; 0 is none: a cleared plane is empty. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Floats above 0 are ordered as their bits. The maximum of keys does not depend on the order in which they come.

uint key_of(float z) { return floatBitsToUint(kSkyDepth) - floatBitsToUint(z); }
float depth_of(uint key) { return uintBitsToFloat(floatBitsToUint(kSkyDepth) - key); }
