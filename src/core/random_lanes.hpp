#pragma once
// Random numbers of the kernels: Philox4x32-10 (Salmon et al., SC11), bit for bit that of Random123. A number
// is a function of what it is for, never of a thread, a batch or a scan point.
#include "core/lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Four random numbers of 32 bits for each particle, in the low halves of lanes; what is above them is
/// unspecified.
///
/// Key: the low and the high half of the seed. Counter: the low and the high half of the particle's number,
/// purpose << 16 | draw, stream. purpose and draw are below 2^16; stream is any 32-bit number (a branch or a
/// scan point).
struct RandomBlock {
  words c0, c1, c2, c3;
};
RABILINE_LANES RandomBlock random_block(words particle, unsigned long long seed, unsigned purpose,
                                        unsigned draw, unsigned stream) {
  constexpr unsigned long long multiplier_0 = 0xD2511F53, multiplier_1 = 0xCD9E8D57;
  constexpr unsigned key_step_0 = 0x9E3779B9, key_step_1 = 0xBB67AE85;
  unsigned key_0 = static_cast<unsigned>(seed), key_1 = static_cast<unsigned>(seed >> 32);
  words c0 = particle, c1 = particle >> 32, c2 = broadcast_word(purpose << 16 | draw),
        c3 = broadcast_word(stream);
#pragma GCC unroll 10
  for (int round = 0; round < 10; ++round) {
    const words p = product_of_low_words(c0, broadcast_word(multiplier_0));
    const words q = product_of_low_words(c2, broadcast_word(multiplier_1));
    c0 = high_word(q) ^ c1 ^ broadcast_word(key_0);
    c1 = q;
    c2 = high_word(p) ^ c3 ^ broadcast_word(key_1);
    c3 = p;
    key_0 += key_step_0;
    key_1 += key_step_1;
  }
  return {c0, c1, c2, c3};
}

/// Two uniform numbers in (0, 1) for each particle: ((x >> 12) + 1/2) 2^-52 of the 64-bit numbers
/// x = (word 0, word 1) and (word 2, word 3), the first word above the second.
RABILINE_LANES void uniforms(words particle, unsigned long long seed, unsigned purpose, unsigned draw,
                             unsigned stream, real& u0, real& u1) {
  const RandomBlock r = random_block(particle, seed, purpose, draw, stream);
  // 52 random bits m as 1 + m 2^-52; taking away 1 - 2^-53 leaves (m + 1/2) 2^-52 exactly.
  const words one = broadcast_word(0x3FF0000000000000ULL);
  u0 = from_bits(joined(r.c0, r.c1) >> 12 | one) - (1.0 - 0x1p-53);
  u1 = from_bits(joined(r.c2, r.c3) >> 12 | one) - (1.0 - 0x1p-53);
}

/// A uniform number in (0, 1) from one word of a block: (word + 1/2) 2^-32.
RABILINE_LANES real coarse_uniform(words word) {
  // Below the exponent of 2^52 the word counts ones.
  return (from_bits(joined(broadcast_word(0x43300000), word)) - (0x1p52 - 0.5)) * 0x1p-32;
}

}  // namespace rabiline::RABILINE_ISA
