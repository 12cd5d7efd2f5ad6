// What is known of the two ends of the surfaces of a pixel along a line. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

const uint kEndsBits = 10u;  // of each surface but the last
const uint kVoteBits = 3u;
const int kMostVotes = 2;  // of a line

/// `votes`: how many of its ends it shares with the surface behind it, less those that it does not, -2 to 2. `width`:
/// px from end to end, as far as the reach, 0 to 127.
uint pack_ends(uint surface, int votes, int width) {
  return (uint(votes + kMostVotes) | uint(width) << kVoteBits) << surface * kEndsBits;
}
int votes_of(uint packed, uint surface) {
  return int(packed >> surface * kEndsBits & (1u << kVoteBits) - 1u) - kMostVotes;
}
int width_of(uint packed, uint surface) {
  return int(packed >> surface * kEndsBits + kVoteBits & (1u << kEndsBits - kVoteBits) - 1u);
}
