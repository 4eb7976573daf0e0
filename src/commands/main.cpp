#include "commands/common.hpp"

int main(int argc, char** argv) { return rabiline::run_program({argv + 1, argv + argc}); }
