// Compiled once for each instruction set: its table of kernels.
#include "transport/kernel_functions.hpp"

namespace rabiline::RABILINE_ISA {

extern const Kernels table;
const Kernels table{emit,     drift,   pass,  screen,  align, precess, filter,  outcomes,    count_shares,
                    collapse, deflect, steer, project, turn,  cross,   measure, measure_spin};

}  // namespace rabiline::RABILINE_ISA
