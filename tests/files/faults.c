/* Lets the operation of a given number on files fail, or ends the program before it. Loaded before the C library.

   FAULT_AT is the number, from 1. FAULT_KIND is "kill", or the number of the error that the operation gives. With FAULT_STAYS set, all
   operations that need room fail from then on, as on a full disk. A line on standard error says that it happened. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long done;

/* Whether the operation that comes is to fail. */
static int fails(int needs_room) {
    const char *at = getenv("FAULT_AT"), *kind = getenv("FAULT_KIND");
    if (!at || !kind) return 0;
    long number = atomic_fetch_add(&done, 1) + 1, first = atol(at);
    if (number != first && !(number > first && needs_room && getenv("FAULT_STAYS"))) return 0;
    if (number == first) syscall(SYS_write, 2, "fault\n", 6);
    if (!strcmp(kind, "kill")) syscall(SYS_kill, getpid(), SIGKILL);
    if (!needs_room && getenv("FAULT_STAYS")) return 0;
    errno = atoi(kind);
    return 1;
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

/* A function that opens a file: one that is only read is not counted. */
#define OPEN(name) \
    int name(const char *path, int flags, ...) { \
        va_list rest; \
        va_start(rest, flags); \
        mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0; \
        va_end(rest); \
        if (flags & (O_WRONLY | O_RDWR | O_CREAT) && fails(flags & O_CREAT)) return -1; \
        return NEXT(name)(path, flags, mode); \
    }
OPEN(open)
OPEN(open64)
ssize_t write(int file, const void *bytes, size_t count) {
    if (file > 2 && fails(1)) return -1;
    return NEXT(write)(file, bytes, count);
}
int fsync(int file) { return fails(1) ? -1 : NEXT(fsync)(file); }
int ftruncate64(int file, off64_t length) { return fails(0) ? -1 : NEXT(ftruncate64)(file, length); }
int mkdir(const char *path, mode_t mode) { return fails(1) ? -1 : NEXT(mkdir)(path, mode); }
int rmdir(const char *path) { return fails(0) ? -1 : NEXT(rmdir)(path); }
int unlink(const char *path) { return fails(0) ? -1 : NEXT(unlink)(path); }
int unlinkat(int folder, const char *path, int flags) { return fails(0) ? -1 : NEXT(unlinkat)(folder, path, flags); }
int rename(const char *from, const char *to) { return fails(0) ? -1 : NEXT(rename)(from, to); }
int chmod(const char *path, mode_t mode) { return fails(0) ? -1 : NEXT(chmod)(path, mode); }
int fchmod(int file, mode_t mode) { return fails(0) ? -1 : NEXT(fchmod)(file, mode); }
