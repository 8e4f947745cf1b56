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
#include <sys/uio.h>
#include <threads.h>
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
WATCHED(locks, int, pthread_mutex_timedlock,
        (pthread_mutex_t* __restrict mutex, const timespec* __restrict until) noexcept, (mutex, until))
WATCHED(locks, int, pthread_mutex_clocklock,
        (pthread_mutex_t* __restrict mutex, clockid_t clock, const timespec* __restrict until) noexcept,
        (mutex, clock, until))
WATCHED(locks, int, pthread_rwlock_rdlock, (pthread_rwlock_t * lock) noexcept, (lock))
WATCHED(locks, int, pthread_rwlock_wrlock, (pthread_rwlock_t * lock) noexcept, (lock))
WATCHED(locks, int, pthread_rwlock_timedrdlock,
        (pthread_rwlock_t* __restrict lock, const timespec* __restrict until) noexcept, (lock, until))
WATCHED(locks, int, pthread_rwlock_timedwrlock,
        (pthread_rwlock_t* __restrict lock, const timespec* __restrict until) noexcept, (lock, until))
WATCHED(locks, int, pthread_spin_lock, (pthread_spinlock_t * lock) noexcept, (lock))
WATCHED(locks, int, pthread_cond_wait, (pthread_cond_t * condition, pthread_mutex_t* mutex), (condition, mutex))
WATCHED(locks, int, pthread_cond_timedwait,
        (pthread_cond_t* __restrict condition, pthread_mutex_t* __restrict mutex, const timespec* __restrict until),
        (condition, mutex, until))
WATCHED(locks, int, pthread_cond_clockwait,
        (pthread_cond_t* __restrict condition, pthread_mutex_t* __restrict mutex, clockid_t clock,
         const timespec* __restrict until),
        (condition, mutex, clock, until))
WATCHED(locks, int, sem_wait, (sem_t * semaphore), (semaphore))
WATCHED(locks, int, sem_timedwait, (sem_t* __restrict semaphore, const timespec* __restrict until), (semaphore, until))
WATCHED(locks, int, mtx_lock, (mtx_t * mutex), (mutex))
WATCHED(locks, int, mtx_timedlock, (mtx_t* __restrict mutex, const timespec* __restrict until), (mutex, until))
WATCHED(locks, int, cnd_wait, (cnd_t * condition, mtx_t* mutex), (condition, mutex))
WATCHED(locks, int, cnd_timedwait,
        (cnd_t* __restrict condition, mtx_t* __restrict mutex, const timespec* __restrict until),
        (condition, mutex, until))
WATCHED(locks, int, thrd_sleep, (const timespec* wanted, timespec* left), (wanted, left))
WATCHED(locks, unsigned, sleep, (unsigned wanted), (wanted))
WATCHED(locks, int, nanosleep, (const timespec* wanted, timespec* left), (wanted, left))
WATCHED(locks, int, clock_nanosleep, (clockid_t clock, int flags, const timespec* wanted, timespec* left),
        (clock, flags, wanted, left))
WATCHED(locks, int, usleep, (useconds_t wanted), (wanted))
WATCHED(locks, int, poll, (pollfd * files, nfds_t count, int timeout), (files, count, timeout))
WATCHED(locks, int, ppoll, (pollfd * files, nfds_t count, const timespec* timeout, const sigset_t* signals),
        (files, count, timeout, signals))
WATCHED(locks, int, pselect,
        (int count, fd_set* in, fd_set* out, fd_set* other, const timespec* timeout, const sigset_t* signals),
        (count, in, out, other, timeout, signals))
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
WATCHED(chance, long, lrand48, () noexcept, ())
WATCHED(chance, long, mrand48, () noexcept, ())
WATCHED(chance, double, erand48, (unsigned short state[3]) noexcept, (state))
WATCHED(chance, long, nrand48, (unsigned short state[3]) noexcept, (state))
WATCHED(chance, long, jrand48, (unsigned short state[3]) noexcept, (state))
WATCHED(chance, ssize_t, getrandom, (void* to, size_t size, unsigned flags), (to, size, flags))
WATCHED(chance, int, getentropy, (void* to, size_t size), (to, size))
WATCHED(chance, std::uint32_t, arc4random, () noexcept, ())
WATCHED(chance, void, arc4random_buf, (void* to, size_t size) noexcept, (to, size))
WATCHED(chance, std::uint32_t, arc4random_uniform, (std::uint32_t bound) noexcept, (bound))

WATCHED(files, FILE*, fopen, (const char* __restrict name, const char* __restrict mode), (name, mode))
// What the C++ library opens its streams with.
WATCHED(files, FILE*, fopen64, (const char* __restrict name, const char* __restrict mode), (name, mode))
WATCHED(files, size_t, fread, (void* __restrict to, size_t size, size_t count, FILE* __restrict file),
        (to, size, count, file))
WATCHED(files, char*, fgets, (char* __restrict to, int size, FILE* __restrict file), (to, size, file))
WATCHED(files, size_t, fwrite, (const void* __restrict from, size_t size, size_t count, FILE* __restrict file),
        (from, size, count, file))
WATCHED(files, int, fputs, (const char* __restrict text, FILE* __restrict file), (text, file))
WATCHED(files, int, fputc, (int letter, FILE* file), (letter, file))
WATCHED(files, int, puts, (const char* text), (text))
WATCHED(files, ssize_t, read, (int file, void* to, size_t size), (file, to, size))
WATCHED(files, ssize_t, write, (int file, const void* from, size_t size), (file, from, size))
WATCHED(files, ssize_t, writev, (int file, const iovec* parts, int count), (file, parts, count))
WATCHED(files, int, vprintf, (const char* __restrict format, va_list arguments), (format, arguments))
WATCHED(files, int, vfprintf, (FILE* __restrict file, const char* __restrict format, va_list arguments),
        (file, format, arguments))
// What the printf family is called where _FORTIFY_SOURCE is defined.
WATCHED(files, int, __vprintf_chk, (int flag, const char* __restrict format, va_list arguments),
        (flag, format, arguments))
WATCHED(files, int, __vfprintf_chk, (FILE* __restrict file, int flag, const char* __restrict format, va_list arguments),
        (file, flag, format, arguments))

// The mode, where the flags say that there is one.
#define WATCHED_OPEN(name, parameters, first)                                          \
    int name parameters {                                                              \
        observe(Concern::files, #name);                                                \
        static const auto next = real<int(*) parameters>(#name);                       \
        va_list arguments;                                                             \
        va_start(arguments, flags);                                                    \
        const bool makes = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE; \
        const mode_t mode = makes ? va_arg(arguments, mode_t) : 0;                     \
        va_end(arguments);                                                             \
        return next first;                                                             \
    }
WATCHED_OPEN(open, (const char* path, int flags, ...), (path, flags, mode))
WATCHED_OPEN(open64, (const char* path, int flags, ...), (path, flags, mode))
WATCHED_OPEN(openat, (int folder, const char* path, int flags, ...), (folder, path, flags, mode))
WATCHED_OPEN(openat64, (int folder, const char* path, int flags, ...), (folder, path, flags, mode))
#undef WATCHED_OPEN

// Each forwards to the C library's form that takes the arguments as a list.
#define WATCHED_PRINTF(name, parameters, list, list_parameters, list_arguments) \
    int name parameters {                                                       \
        observe(Concern::files, #name);                                         \
        static const auto next = real<int(*) list_parameters>(#list);           \
        va_list arguments;                                                      \
        va_start(arguments, format);                                            \
        const int written = next list_arguments;                                \
        va_end(arguments);                                                      \
        return written;                                                         \
    }
WATCHED_PRINTF(printf, (const char* __restrict format, ...), vprintf, (const char*, va_list), (format, arguments))
WATCHED_PRINTF(fprintf, (FILE* __restrict file, const char* __restrict format, ...), vfprintf,
               (FILE*, const char*, va_list), (file, format, arguments))
WATCHED_PRINTF(__printf_chk, (int flag, const char* __restrict format, ...), __vprintf_chk, (int, const char*, va_list),
               (flag, format, arguments))
WATCHED_PRINTF(__fprintf_chk, (FILE* __restrict file, int flag, const char* __restrict format, ...), __vfprintf_chk,
               (FILE*, int, const char*, va_list), (file, flag, format, arguments))
#undef WATCHED_PRINTF
#pragma GCC diagnostic pop
}

#undef WATCHED

#endif
