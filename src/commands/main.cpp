#include <cstdio>
#include <new>

#include "commands/common.hpp"

// Where there is no memory at all, messages are said without any.
int main(int argc, char** argv) try {
  return rabiline::run_program({argv + 1, argv + argc});
} catch (const std::bad_alloc&) {
  std::fputs("error: not enough memory\n", stderr);
  return rabiline::exit_code::bad_input;
} catch (...) {
  std::fputs("error: this is a mistake of the program: please report it with the input file\n", stderr);
  return rabiline::exit_code::mistake;
}
