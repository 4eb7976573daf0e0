#pragma once
// Rough times that one particle takes on one core with AVX-512 [s]; only their order of magnitude matters.
namespace rabiline::cost {

inline constexpr double plane = 3e-9, emission = 1e-8, step = 4e-9, twisted_step = 1.5e-8,
                        laboratory_step = 1e-7, linear_field = 1.5e-8, shaped_field = 5e-8, crossing = 8e-8,
                        joint_span = 2.5e-8, slow_span = 5e-8, zone = 5e-9, closed_form = 2e-9, tally = 1e-8,
                        share = 5e-9, multiply = 5e-10, operation = 5e-11, moment = 3e-9;

}  // namespace rabiline::cost
