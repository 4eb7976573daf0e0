#pragma once
// Levels that fields mix, as plain numbers that kernels walk along.

namespace rabiline {

/// The levels of one block start each as themselves: a = M_0 e. Then `steps` times, for a slowness s = 1/v,
/// a_k -> exp(-2 pi i (angle_k + rate_k s)) a_k and a -> M a. The probabilities are |a_k|^2, averaged over
/// the samples of the random start phases, which differ in their angles.
///
/// Numbers, one after the other, in rows of `levels`: M_0 (row: to, column: from); for each step the rates
/// [cycles per s/m], the angles [cycles] of each sample, and M. What the first level has is taken off the
/// rates and angles of all. Of two levels the state is Bloch's vector instead, x + i y = 2 a_0* a_1 and
/// z = |a_0|^2 - |a_1|^2, and M is the five numbers z from z, z from x, x from z, x from x and y from y.
struct LevelBlock {
  int levels = 0, steps = 0, samples = 1;
  int first_level = 0, first_number = 0;  // where they begin in the arrays of all blocks
};

}  // namespace rabiline
