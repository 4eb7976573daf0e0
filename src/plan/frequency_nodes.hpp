#pragma once
// Scans of a frequency that drives the levels of atoms: few frequencies serve all points.
//
// In the frame of the drive H/h = H_0 - f N, where N counts the photons of each level. So for a particle that
// takes the time T from the first drive to the last, the probability to go from one level to another is a
// function of f whose Fourier transform ends at dN T, dN the most photons that two of the levels are apart.
// Over a range of f it is of exponential type tau = pi dN T (f_max - f_min), the range taken as [-1, 1], and
// between 0 and 1 for every real f. Through n Chebyshev points it converges once n is beyond tau, whatever
// the number of scan points (L. N. Trefethen, Approximation Theory and Approximation Practice (2013),
// theorem 8.2). Slow particles need more points than fast ones.
#include "particle/speed.hpp"
#include "plan/plan.hpp"

namespace rabiline {

/// Where that is the shorter way, reweightings follow from frequency nodes, whose sums stand at the end of
/// `sums`; transitions there are added to the tables. `speeds`: of nearly all particles of the tree;
/// `threads`: as for in_parallel().
void lay_out_frequency_nodes(PlanTree&, SampledTables&, const SpeedRange& speeds, int threads,
                             std::size_t& sums);

}  // namespace rabiline
