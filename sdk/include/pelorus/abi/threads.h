/* Pelorus ABI: the words that say which thread may make a call.
 *
 * Every function of every table carries one of these tags:
 *
 *   [main]                one thread at a time in the whole process; no other call on the same instance is under way.
 *                         May allocate, read files, take its time.
 *   [worker, exclusive]   any thread, but never two calls on the same instance at once. Successive calls may come from
 *                         different threads; the host orders them (what one call wrote, the next one sees).
 *   [worker, concurrent]  any number of threads at once on the same instance. The instance must not change.
 *   [any]                 a host service that may be called from within any call.
 *
 * and, where it matters, also
 *
 *   [hot]                 called per scan or per track: neither allocates, locks, blocks, nor reads a clock.
 *                         Memory it needs beyond its stack comes from `plr_call.scratch`.
 *
 * Rationale: a model is immutable after creation, so concurrency costs its author nothing; state lives in records that
 * the caller owns. A stage holds state, so it is called exclusively. No table has a third way, because a third way is
 * what authors get wrong.
 */
#ifndef PELORUS_ABI_THREADS_H
#define PELORUS_ABI_THREADS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define PLR_EXTERN_C_BEGIN extern "C" {
#define PLR_EXTERN_C_END }
#define PLR_STATIC_ASSERT(condition, text) static_assert(condition, text)
#else
#define PLR_EXTERN_C_BEGIN
#define PLR_EXTERN_C_END
#define PLR_STATIC_ASSERT(condition, text) _Static_assert(condition, text)
#endif

/* The ABI as a whole. A host refuses another major; a minor only adds. Minors count from 1: so a host of the one before, which
 * conformance plays, can always be told. */
#define PLR_ABI_MAJOR 1
#define PLR_ABI_MINOR 1

#endif
