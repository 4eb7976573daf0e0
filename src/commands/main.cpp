#include <cstdio>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "commands/common.hpp"
#include "core/thread_stacks.hpp"

namespace {

// Where there is no memory at all, messages are said without any.
int run(int argc, char** argv) try {
  return rabiline::run_program({argv + 1, argv + argc});
} catch (const std::bad_alloc&) {
  std::fputs("error: not enough memory\n", stderr);
  return rabiline::exit_code::bad_input;
} catch (...) {
  std::fputs("error: this is a mistake of the program: please report it with the input file\n", stderr);
  return rabiline::exit_code::mistake;
}

}  // namespace

int main(int argc, char** argv) {
  if (!rabiline::first_thread_is_narrow()) return run(argc, argv);
  rabiline::widen_thread_stacks();
  int code = rabiline::exit_code::mistake;
  std::thread([&] { code = run(argc, argv); }).join();
  return code;
}
