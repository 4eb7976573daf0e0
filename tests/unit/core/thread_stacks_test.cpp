#include "core/thread_stacks.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <cstddef>

namespace rabiline::thread_stacks_test {
namespace {

#ifdef __GLIBC__
std::size_t stack_of_threads() {
  pthread_attr_t attributes;
  std::size_t size = 0;
  EXPECT_EQ(pthread_getattr_default_np(&attributes), 0);
  EXPECT_EQ(pthread_attr_getstacksize(&attributes, &size), 0);
  pthread_attr_destroy(&attributes);
  return size;
}
void give_threads(std::size_t size) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, size), 0);
  ASSERT_EQ(pthread_setattr_default_np(&attributes), 0);
  pthread_attr_destroy(&attributes);
}

TEST(ThreadStacks, AreWidenedAndNeverNarrowed) {
  const std::size_t before = stack_of_threads(), mebibyte = std::size_t{1} << 20;
  give_threads(mebibyte);
  widen_thread_stacks();
  EXPECT_EQ(stack_of_threads(), 8 * mebibyte);
  give_threads(9 * mebibyte);
  widen_thread_stacks();
  EXPECT_EQ(stack_of_threads(), 9 * mebibyte);
  give_threads(before);
}
#endif

}  // namespace
}  // namespace rabiline::thread_stacks_test
