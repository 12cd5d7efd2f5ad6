// For the wheel: hypot() of glibc 2.35 differs from the one before in errno alone, and systems of 2.34 lack it.
// SPDX-License-Identifier: BSD-3-Clause
__asm__(".symver hypot, hypot@GLIBC_2.2.5");
