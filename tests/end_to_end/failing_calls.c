/* Preloaded: the call named by FAIL_CALL fails at the FAIL_AT-th time, or at every time from there on if FAIL_ON is set. At the
   first failure a file FAIL_SEEN appears. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

static long count, at = -1;
static int on;
static char call[16];

__attribute__((constructor)) static void begin(void) {
  const char* name = getenv("FAIL_CALL");
  if (name != NULL) strncpy(call, name, sizeof call - 1);
  on = getenv("FAIL_ON") != NULL;
  if (getenv("FAIL_AT") != NULL) at = atol(getenv("FAIL_AT"));
}

static int fails(const char* name) {
  if (at < 0 || strcmp(name, call) != 0) return 0;
  const long now = __atomic_add_fetch(&count, 1, __ATOMIC_RELAXED);
  if (now == at && getenv("FAIL_SEEN") != NULL) syscall(SYS_mknod, getenv("FAIL_SEEN"), S_IFREG | 0600, 0);
  return now == at || (on && now > at);
}

#define NEXT(type, name, ...) \
  static type (*next)(__VA_ARGS__); \
  if (next == NULL) next = (type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)

ssize_t write(int file, const void* bytes, size_t size) {
  NEXT(ssize_t, "write", int, const void*, size_t);
  if (file > 2 && fails("write")) return errno = ENOSPC, -1;
  return next(file, bytes, size);
}
int fsync(int file) {
  NEXT(int, "fsync", int);
  return fails("fsync") ? (errno = EIO, -1) : next(file);
}
int rename(const char* from, const char* to) {
  NEXT(int, "rename", const char*, const char*);
  return fails("rename") ? (errno = EIO, -1) : next(from, to);
}
int close(int file) {
  NEXT(int, "close", int);
  const int result = next(file);
  return fails("close") ? (errno = EIO, -1) : result;
}
int open(const char* path, int flags, ...) {
  NEXT(int, "open", const char*, int, ...);
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  return fails("open") ? (errno = EACCES, -1) : next(path, flags, mode);
}
extern void* __libc_malloc(size_t);
void* malloc(size_t size) { return fails("malloc") ? (errno = ENOMEM, NULL) : __libc_malloc(size); }
