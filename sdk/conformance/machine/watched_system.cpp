// Locks, clocks, chance and files, seen on their way to the C library. Built into the runner unless sanitizers do the same.
#include "watched_functions.hpp"

#if defined(PELORUS_CONFORM_WATCHES)

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/random.h>
#include <sys/select.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace {

using pelorus::conformance::watch::Concern;
using pelorus::conformance::watch::observe;

/// The C library's own function of that name.
template <class Function> Function real(const char* name) noexcept {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

// Each forwards to the next definition of its name, found once.
#define WATCHED(concern, result, name, parameters, arguments)       \
    result name parameters {                                        \
        observe(Concern::concern, #name);                           \
        static const auto next = real<result(*) parameters>(#name); \
        return next arguments;                                      \
    }

extern "C" {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnonnull-compare"
WATCHED(locks, int, pthread_mutex_lock, (pthread_mutex_t * mutex) noexcept, (mutex))
WATCHED(locks, int, pthread_rwlock_rdlock, (pthread_rwlock_t * lock) noexcept, (lock))
WATCHED(locks, int, pthread_rwlock_wrlock, (pthread_rwlock_t * lock) noexcept, (lock))
WATCHED(locks, int, pthread_spin_lock, (pthread_spinlock_t * lock) noexcept, (lock))
WATCHED(locks, int, pthread_cond_wait, (pthread_cond_t * condition, pthread_mutex_t* mutex), (condition, mutex))
WATCHED(locks, int, sem_wait, (sem_t * semaphore), (semaphore))
WATCHED(locks, int, nanosleep, (const timespec* wanted, timespec* left), (wanted, left))
WATCHED(locks, int, clock_nanosleep, (clockid_t clock, int flags, const timespec* wanted, timespec* left),
        (clock, flags, wanted, left))
WATCHED(locks, int, usleep, (useconds_t wanted), (wanted))
WATCHED(locks, int, poll, (pollfd * files, nfds_t count, int timeout), (files, count, timeout))
WATCHED(locks, int, select, (int count, fd_set* in, fd_set* out, fd_set* other, timeval* timeout),
        (count, in, out, other, timeout))

WATCHED(clocks, int, clock_gettime, (clockid_t clock, timespec* now) noexcept, (clock, now))
WATCHED(clocks, int, gettimeofday, (timeval* __restrict now, void* __restrict zone) noexcept, (now, zone))
WATCHED(clocks, time_t, time, (time_t * now) noexcept, (now))
WATCHED(clocks, clock_t, clock, () noexcept, ())
WATCHED(clocks, int, timespec_get, (timespec * now, int base) noexcept, (now, base))

WATCHED(chance, int, rand, () noexcept, ())
WATCHED(chance, int, rand_r, (unsigned* seed) noexcept, (seed))
WATCHED(chance, long, random, () noexcept, ())
WATCHED(chance, double, drand48, () noexcept, ())
WATCHED(chance, ssize_t, getrandom, (void* to, size_t size, unsigned flags), (to, size, flags))
WATCHED(chance, int, getentropy, (void* to, size_t size), (to, size))
WATCHED(chance, std::uint32_t, arc4random, () noexcept, ())

WATCHED(files, FILE*, fopen, (const char* __restrict name, const char* __restrict mode), (name, mode))
WATCHED(files, size_t, fwrite, (const void* __restrict from, size_t size, size_t count, FILE* __restrict file),
        (from, size, count, file))
WATCHED(files, int, fputs, (const char* __restrict text, FILE* __restrict file), (text, file))
WATCHED(files, int, puts, (const char* text), (text))
WATCHED(files, ssize_t, read, (int file, void* to, size_t size), (file, to, size))
WATCHED(files, ssize_t, write, (int file, const void* from, size_t size), (file, from, size))

int open(const char* name, int flags, ...) {
    observe(Concern::files, "open");
    static const auto next = real<int (*)(const char*, int, ...)>("open");
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    return next(name, flags, mode);
}
int printf(const char* __restrict format, ...) {
    observe(Concern::files, "printf");
    va_list arguments;
    va_start(arguments, format);
    const int written = vfprintf(stdout, format, arguments);
    va_end(arguments);
    return written;
}
int fprintf(FILE* __restrict file, const char* __restrict format, ...) {
    observe(Concern::files, "fprintf");
    va_list arguments;
    va_start(arguments, format);
    const int written = vfprintf(file, format, arguments);
    va_end(arguments);
    return written;
}
#pragma GCC diagnostic pop
}

#undef WATCHED

#endif
